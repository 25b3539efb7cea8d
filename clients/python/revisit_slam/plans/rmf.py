"""Open-RMF building maps (`*.building.yaml`): levels with named vertices, doors and lifts, drawn on an image or on the earth."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import RevisitError
from ..files import not_a, text_of
from ..needed import needed
from .places import metres_of
from .plan import Plan, Point, Sign, words

FORM = "a building map with levels"
# What x and y are: pixels of an image, pixels of the world drawn on 256 x 256, metres, or longitude and latitude.
IMAGE, MERCATOR, METRES, DEGREES = SYSTEMS = ("reference_image", "web_mercator", "cartesian_meters", "wgs84")
# Vertices with these properties are places of robots, not of signs.
ROBOT_PROPERTIES = ("is_charger", "spawn_robot_name", "is_cleaning_zone")


def read_rmf(path: Path, level: str | None, language: str = "") -> Plan:
    """Read a building map: a sign at each named door and each named vertex, of one floor or of all."""
    yaml = needed("yaml", "pyyaml", "plans")
    try:
        building = yaml.safe_load(text_of(path, FORM))
        # A level may be called 1, which is a number there.
        building["levels"] = {str(name): drawn for name, drawn in dict(building["levels"]).items() if isinstance(drawn, dict)}
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise not_a(FORM, path) from error
    if building.get("coordinate_system", IMAGE) not in SYSTEMS:
        raise RevisitError(f"{path}: coordinate_system {building['coordinate_system']} is not known, only {', '.join(SYSTEMS)}")
    plan = Plan(path.name)
    floors = [_Floor(plan, building, name) for name in building["levels"]]
    scale = next((floor.scale for floor in floors if floor.scale), None)
    for floor in floors:
        scale = floor.scale or scale
        if level in (None, floor.name):
            floor.add(scale)
    return plan


class _Floor:
    """A level of a building map."""

    def __init__(self, plan: Plan, building: dict[str, Any], name: str) -> None:
        self._plan, self._building, self._drawn, self.name = plan, building, building["levels"][name], name
        self._system = building.get("coordinate_system", IMAGE)
        # As it is drawn: of each vertex its place, its name and its properties.
        self._vertices: dict[int, tuple[Point, str, dict[str, Any]]] = {}
        for number, vertex in enumerate(self._drawn.get("vertices") or []):
            with plan.left_out.unless(f"{name}: vertex {number}", "no vertex of x, y, z, a name and properties"):
                x, y, *more = vertex
                text, properties = (*more[1:], "", {})[:2]
                self._vertices[number] = self._as_drawn(x, y), words(text), dict(properties or {})
        self.scale = self._metres_per_pixel() if self._system == IMAGE else 1.0

    def add(self, scale: float | None) -> None:
        """Add the floor's signs; without measurements of its own it has another floor's scale."""
        if not self._vertices:
            return
        if scale is None:
            raise RevisitError(f"{self._plan.source}: level {self.name} has no measurement, so its scale is unknown")
        if self.scale is None:
            self._plan.assumed.append(f"level {self.name} has no measurement: another level's {scale:.4g} m a pixel are taken")
        at = lambda x, y: (x * scale, y * scale)  # noqa: E731
        if self._system in (MERCATOR, DEGREES):
            at = metres_of((place for place, *_ in self._vertices.values()), self._plan.source)
        found = [*self._doors(), *self._named_vertices(), *self._lifts()]
        self._plan.signs += [Sign(self.name, text, at(*place)) for text, place in found]

    def _as_drawn(self, x: Any, y: Any) -> Point:
        """Return a place with y up: in pixels, in metres, or in degrees."""
        x, y = float(x), float(y)
        if not (math.isfinite(x) and math.isfinite(y)):
            raise ValueError("no place")
        if self._system == IMAGE:
            return x, -y
        if self._system == METRES:
            told = self._building.get("parameters") or {}
            return x - float(_value(told.get("offset_x")) or 0), y - float(_value(told.get("offset_y")) or 0)
        if self._system == MERCATOR:
            # From the north; later editors write it below zero.
            return (x / 128 - 1) * 180, math.degrees(math.atan(math.sinh(math.pi * (1 - abs(y) / 128))))
        return x, y

    def _edges(self, kind: str) -> Iterator[tuple[Point, Point, dict[str, Any]]]:
        """Yield the ends and the properties of each door or measurement."""
        for number, edge in enumerate(self._drawn.get(kind) or []):
            with self._plan.left_out.unless(f"{self.name}: {number} of {kind}", "it names no two vertices of its level"):
                start, end, *properties = edge
                yield self._vertices[start][0], self._vertices[end][0], dict(*properties)

    def _metres_per_pixel(self) -> float | None:
        """Return the median of what the measurements say."""
        scales = []
        for a, b, properties in self._edges("measurements"):
            metres = _value(properties.get("distance"))
            if math.dist(a, b) > 0 and isinstance(metres, (int, float)) and metres > 0:
                scales.append(metres / math.dist(a, b))
        return statistics.median(scales) if scales else None

    def _doors(self) -> Iterator[tuple[str, Point]]:
        for a, b, properties in self._edges("doors"):
            if name := words(_value(properties.get("name"))):
                yield name, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)

    def _named_vertices(self) -> Iterator[tuple[str, Point]]:
        for place, name, properties in self._vertices.values():
            if name and any(_value(properties.get(key)) for key in ROBOT_PROPERTIES):
                self._plan.left_out.add(f"{self.name}: {name}", "places of robots, no signs")
            elif name:
                yield name, place

    def _lifts(self) -> Iterator[tuple[str, Point]]:
        """Yield the lifts that stop here. Each is drawn on one level; fiducials tell where that is on the others."""
        for name, lift in (self._building.get("lifts") or {}).items():
            place = None
            with self._plan.left_out.unless(f"{self.name}: {name}", "a lift without a place"):
                if self.name in map(str, lift.get("level_doors") or {}):
                    place = complex(*self._as_drawn(lift["x"], lift["y"]))
            if place is None:
                continue
            told = (lift.get("reference_floor_name"), self._building.get("reference_level_name"), *self._building["levels"])
            reference = next(str(level) for level in told if level is not None)
            is_here = reference == self.name or self._system != IMAGE
            here = place if is_here else self._from_level(reference, place)
            if here is None:
                self._plan.notes.append(f"{self.name}: {name} is drawn on level {reference}, and no fiducials tell where here")
            else:
                yield str(name), (here.real, here.imag)

    def _from_level(self, level: str, place: complex) -> complex | None:
        """Return a place of another level's image in this one's, by the fiducials that both have."""
        theirs, ours = self._fiducials(level), self._fiducials(self.name)
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

    def _fiducials(self, level: str) -> dict[str, complex]:
        drawn = (self._building["levels"].get(level) or {}).get("fiducials") or []
        return {str(one[2]): complex(*self._as_drawn(*one[:2])) for one in drawn if isinstance(one, list) and len(one) == 3}


def _value(property_: Any) -> Any:
    """Return the value of a property, which is written with its type: `[1, name]`."""
    return property_[1] if isinstance(property_, list) and len(property_) == 2 else property_
