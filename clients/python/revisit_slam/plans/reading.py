"""Reading of a plan by the form of its file."""

from __future__ import annotations

from pathlib import Path

from ..errors import RevisitError
from .geojson import read_geojson
from .osm import read_osm
from .plan import Plan
from .rmf import read_rmf

READERS = {".yaml": read_rmf, ".yml": read_rmf, ".geojson": read_geojson, ".json": read_geojson, ".osm": read_osm, ".xml": read_osm}


def read_plan(path: Path, level: str | None = None) -> Plan:
    """Read a plan; `level` names the floor of a file that has one, or picks one of several."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise RevisitError(f"{path}: a plan is a .building.yaml, a .geojson or an .osm file")
    try:
        plan = reader(path, level)
    except OSError as error:
        raise RevisitError(f"{path}: cannot be read: {error.strerror}") from error
    if not plan.signs:
        plan.notes.append("no signs found" + (f" on level {level}" if level else ""))
    return plan
