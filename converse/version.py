"""The program's version, in the one place where it stands."""

__version__ = "1.5.0"
