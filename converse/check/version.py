"""The checker's version: that of the program whose files it checks, of which it imports nothing."""

__version__ = "1.13.0"
