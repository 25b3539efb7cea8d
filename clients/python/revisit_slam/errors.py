"""Base of the package's errors, and how a person is told of them."""

MAX_TOLD = 600
# Of an error, which has every reason with five names each.
MAX_ERROR = 4000


class RevisitError(Exception):
    """Base of every error that this package raises on purpose."""


def one_line(told: object, most: int = MAX_TOLD) -> str:
    """Return a sentence as it may be printed: what a damaged file calls its parts may be long, or have lines of its own."""
    line = "".join(letter if letter.isprintable() else "?" for letter in str(told))
    return line if len(line) <= most else f"{line[:most]} .."
