"""Reading of a plan by the form of its file."""

from __future__ import annotations

import math
import statistics
from pathlib import Path

from ..errors import RevisitError
from ..files import first_bytes, what_is
from .geojson import read_geojson
from .osm import read_osm
from .places import REPROJECT
from .plan import Plan
from .rmf import read_rmf

READERS = {".yaml": read_rmf, ".yml": read_rmf, ".geojson": read_geojson, ".json": read_geojson, ".osm": read_osm, ".xml": read_osm}
# No floor is larger across.
FLOOR_MAX_M = 5_000


def read_plan(path: Path, level: str | None = None, language: str = "") -> Plan:
    """Read a plan; `level` names the floor of a file that has one, or picks one of several.

    Raises:
        RevisitError: It is no plan, or a floor of it is larger than floors are.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        told = "a folder" if path.is_dir() else what_is(first_bytes(path))
        told = f", and this is {told}" if told else ""
        raise RevisitError(f"{path}: a plan is a .building.yaml, a .geojson or an .osm file{told}")
    plan = reader(path, level, language)
    for level_name, signs in plan.levels().items():
        middle = statistics.median(sign.at[0] for sign in signs), statistics.median(sign.at[1] for sign in signs)
        far_m = {sign: math.dist(sign.at, middle) for sign in signs if not math.dist(sign.at, middle) <= FLOOR_MAX_M / 2}
        if 2 * len(far_m) >= len(signs):
            size = f"level {level_name} is {2 * max(far_m.values()) / 1000:.0f} km across, which no floor is"
            unit = "metres, as its coordinate_system says" if reader is read_rmf else f"degrees ({REPROJECT})"
            raise RevisitError(f"{path}: {size}; its places are taken for {unit}")
        for sign in far_m:
            plan.left_out.add(f"{level_name}: {sign.text}", "km away from the other signs of its floor")
        plan.signs = [sign for sign in plan.signs if sign not in far_m]
    if not plan.signs:
        plan.notes.append("no signs found" + (f" on level {level}" if level else ""))
    return plan
