"""Indoor GeoJSON: a file for each floor, with rooms and doors as polygons or points in degrees."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..errors import RevisitError
from .places import centre, origin_of
from .plan import Plan, Point
from .rooms import Room, add_rooms

# The members that name the kind of a feature, in the schemas that are met most: WRLD, IMDF, OpenStreetMap's indoor tags.
KINDS = ("type", "indoor", "category", "feature_type")
# What a sign says, the number before the name.
TEXTS = ("roomnumber", "ref", "name")
LEVELS = ("level", "level_id", "floor")
DOOR = "door"
# Kinds that bear no sign of their own, whatever name the drawing gives them.
NO_ROOMS = ("wall", "window", "door", "building_outline", "level", "venue", "building", "inaccessible_space", "column")


def read_geojson(path: Path, level: str | None) -> Plan:
    """Read a floor, or several where features say theirs."""
    try:
        features = json.loads(path.read_text(encoding="utf-8"))["features"]
        drawn = [feature for feature in features if feature.get("geometry")]
        outlines = [_outline(feature["geometry"]) for feature in drawn]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise RevisitError(f"{path}: not a GeoJSON collection of features") from error
    plan = Plan(path.name)
    if not drawn:
        return plan
    metres = origin_of(place for outline in outlines for place in outline)
    floors: dict[str, tuple[list[Room], list[Point]]] = {}
    for feature, degrees in zip(drawn, outlines):
        properties = feature.get("properties") or {}
        name = level or _first(properties, LEVELS) or path.stem
        rooms, doors = floors.setdefault(str(name), ([], []))
        outline = [metres(*place) for place in degrees]
        kinds = {str(properties[key]).lower() for key in KINDS if properties.get(key) is not None}
        text = _first(properties, TEXTS)
        if DOOR in kinds or properties.get(DOOR) not in (None, "no"):
            doors.append(centre(outline))
        if text and not kinds.intersection(NO_ROOMS):
            rooms.append(Room(text, outline if len(outline) > 1 else outline * 2))
    for name, (rooms, doors) in floors.items():
        add_rooms(plan, name, rooms, doors)
    return plan


def _first(properties: dict[str, Any], keys: tuple[str, ...]) -> str | None:
    found = (str(properties[key]).strip() for key in keys if properties.get(key) not in (None, ""))
    return next((text for text in found if text), None)


def _outline(geometry: dict[str, Any]) -> list[Point]:
    """Return the outer ring of a polygon, the first of several, or the places of a line or a point."""
    places = geometry["coordinates"]
    depth = {"Point": 0, "LineString": 1, "MultiPoint": 1, "Polygon": 2, "MultiLineString": 2, "MultiPolygon": 3}
    for _ in range(depth[geometry["type"]] - 1):
        places = places[0]
    if geometry["type"] == "Point":
        places = [places]
    return [(float(place[0]), float(place[1])) for place in places]
