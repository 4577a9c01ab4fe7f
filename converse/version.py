"""The program's version.  Only check/version.py repeats it."""

__version__ = "6.3.0"
