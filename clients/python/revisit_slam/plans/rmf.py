"""Open-RMF building maps (`*.building.yaml`): levels with named vertices, doors and lifts, drawn in pixels of an image."""

from __future__ import annotations

import math
import statistics
from pathlib import Path
from typing import Any

from ..errors import RevisitError
from .places import LocalMetres, origin_of
from .plan import Plan, Point, Sign

# Vertices with these properties are places of robots, not of signs.
ROBOT_PROPERTIES = ("is_charger", "spawn_robot_name", "is_cleaning_zone")


def read_rmf(path: Path, level: str | None) -> Plan:
    """Read a building map: a sign at each named door and each named vertex, of one floor or of all."""
    try:
        import yaml
    except ImportError as error:
        raise RevisitError("building maps need PyYAML: pip install 'revisit-slam[plans]'") from error
    try:
        building = yaml.safe_load(path.read_text(encoding="utf-8"))
        levels = dict(building["levels"])
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise RevisitError(f"{path}: not a building map: it has no levels") from error
    plan = Plan(path.name)
    scale = None
    for name, drawn in levels.items():
        if level is not None and name != level:
            continue
        scale = _Floor(plan, building, name, drawn, scale).add()
    return plan


class _Floor:
    """A level of a building map."""

    def __init__(self, plan: Plan, building: dict[str, Any], name: str, drawn: dict[str, Any], scale: float | None) -> None:
        self._plan, self._building, self._name, self._drawn = plan, building, str(name), drawn
        self._vertices = list(drawn.get("vertices") or [])
        self._scale = self._metres_per_pixel() or scale

    def add(self) -> float | None:
        """Add the floor's signs; return its scale, which a floor without measurements takes over."""
        if not self._vertices:
            return self._scale
        in_degrees = self._building.get("coordinate_system") == "wgs84"
        if not in_degrees and self._scale is None:
            raise RevisitError(f"{self._plan.source}: level {self._name} has no measurement, so its scale is unknown")
        degrees = origin_of((float(v[0]), float(v[1])) for v in self._vertices) if in_degrees else None
        named = self._vertex_signs(degrees)
        doors = self._door_signs(degrees)
        self._plan.signs += doors + named + self._lift_signs(degrees)
        return self._scale

    def _at(self, x: float, y: float, degrees: LocalMetres | None) -> Point:
        if degrees is not None:
            return degrees(x, y)
        # An image's y points down.
        return x * (self._scale or 1.0), -y * (self._scale or 1.0)

    def _vertex(self, number: int, degrees: LocalMetres | None) -> Point:
        return self._at(float(self._vertices[number][0]), float(self._vertices[number][1]), degrees)

    def _metres_per_pixel(self) -> float | None:
        """Return the median of what the measurements say."""
        scales = []
        for start, end, properties in self._drawn.get("measurements") or []:
            a, b = self._vertices[start], self._vertices[end]
            pixels = math.hypot(float(a[0]) - float(b[0]), float(a[1]) - float(b[1]))
            metres = float(_value(properties.get("distance")) or 0)
            if pixels > 0 and metres > 0:
                scales.append(metres / pixels)
        return statistics.median(scales) if scales else None

    def _door_signs(self, degrees: LocalMetres | None) -> list[Sign]:
        signs = []
        for start, end, properties in self._drawn.get("doors") or []:
            name = str(_value(properties.get("name")) or "")
            a, b = self._vertex(start, degrees), self._vertex(end, degrees)
            if name:
                signs.append(Sign(self._name, name, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)))
        return signs

    def _vertex_signs(self, degrees: LocalMetres | None) -> list[Sign]:
        signs, left_out = [], []
        for number, vertex in enumerate(self._vertices):
            name = str(vertex[3]) if len(vertex) > 3 else ""
            properties = vertex[4] if len(vertex) > 4 and isinstance(vertex[4], dict) else {}
            if not name:
                continue
            if any(_value(properties.get(key)) for key in ROBOT_PROPERTIES):
                left_out.append(name)
            else:
                signs.append(Sign(self._name, name, self._vertex(number, degrees)))
        if left_out:
            self._plan.notes.append(f"{self._name}: {', '.join(left_out)}: places of robots, no signs")
        return signs

    def _lift_signs(self, degrees: LocalMetres | None) -> list[Sign]:
        """Return the lifts that stop here. Each is drawn on one level; fiducials tell where that is on the others."""
        signs = []
        for name, lift in (self._building.get("lifts") or {}).items():
            if self._name not in map(str, lift.get("level_doors") or {}):
                continue
            reference = str(lift.get("reference_floor_name"))
            place = complex(float(lift["x"]), float(lift["y"]))
            here = place if reference == self._name else self._from_level(reference, place)
            if here is None:
                self._plan.notes.append(f"{self._name}: {name} is drawn on level {reference}, and no fiducials tell where here")
            else:
                signs.append(Sign(self._name, str(name), self._at(here.real, here.imag, degrees)))
        return signs

    def _from_level(self, level: str, place: complex) -> complex | None:
        """Return a place of another level's image in this one's, by the fiducials that both have."""
        levels = {str(name): drawn for name, drawn in self._building["levels"].items()}
        theirs, ours = _fiducials(levels.get(level) or {}), _fiducials(self._drawn)
        shared = sorted(theirs.keys() & ours.keys())
        if len(shared) < 2:
            return None
        # The similarity of least squares: turned, scaled and moved.
        from_mean = sum(theirs[name] for name in shared) / len(shared)
        to_mean = sum(ours[name] for name in shared) / len(shared)
        spread = sum(abs(theirs[name] - from_mean) ** 2 for name in shared)
        if spread == 0:
            return None
        turned = sum((theirs[name] - from_mean).conjugate() * (ours[name] - to_mean) for name in shared) / spread
        return to_mean + turned * (place - from_mean)


def _fiducials(drawn: dict[str, Any]) -> dict[str, complex]:
    return {str(name): complex(float(x), float(y)) for x, y, name in drawn.get("fiducials") or []}


def _value(property_: Any) -> Any:
    """Return the value of a property, which is written with its type: `[1, name]`."""
    return property_[1] if isinstance(property_, list) and len(property_) == 2 else property_
