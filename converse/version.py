"""The program's version, in the one place where it stands, but for check/version.py."""

__version__ = "3.0.0"
