"""Base of the package's errors."""


class RevisitError(Exception):
    """Base of every error that this package raises on purpose."""
