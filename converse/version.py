"""The program's version.  Only check/version.py repeats it."""

__version__ = "5.2.0"
