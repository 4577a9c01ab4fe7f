"""The program's version, in the one place where it stands, but for check/version.py."""

__version__ = "2.0.0"
