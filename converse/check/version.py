"""The checker's version, which is also the version of the program, and is not imported from it."""

__version__ = "6.3.0"
