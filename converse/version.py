"""The program's version.  Only check/version.py repeats it."""

__version__ = "3.0.0"
