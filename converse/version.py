"""The program's version.  Only check/version.py repeats it."""

__version__ = "4.2.0"
