"""The checker's version: that of the program whose files it checks, of which it imports nothing."""

__version__ = "2.0.0"
