"""Ids of keyframes, made from the names of what they come from."""

from __future__ import annotations

import re
from pathlib import Path

from ..errors import RevisitError

MAX_ID = 128


def plain_id(name: str, path: Path) -> str:
    """Return a name with only what the API allows in an id; `path` is named where it is too long."""
    if len(name) > MAX_ID:
        raise RevisitError(f"{path}: its name has more than {MAX_ID} characters")
    return re.sub(r"[^A-Za-z0-9._:-]", "_", name)
