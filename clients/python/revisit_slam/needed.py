"""Needed: packages of an extra, asked for only where something needs them."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import RevisitError


def needed(module: str, package: str | None = None, extra: str = "import") -> Any:
    """Import a module, or say which extra brings it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise RevisitError(f"{package or module} is missing: install the package with its extra, revisit-slam[{extra}]") from error
