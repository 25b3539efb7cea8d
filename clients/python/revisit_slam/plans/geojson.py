"""Indoor GeoJSON: a file for each floor, with rooms and doors as polygons or points in degrees. IMDF (OGC 20-094) too."""

from __future__ import annotations

import contextlib
import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import RevisitError
from ..files import not_a, text_of
from .places import REPROJECT, centre, metres_of
from .plan import Plan, Point, texts_by_language, words
from .rooms import Room, add_rooms

FORM = "a GeoJSON collection of features"
# The members that name the kind of a feature, in the schemas that are met most: WRLD, IMDF, OpenStreetMap's indoor tags.
KINDS = ("type", "indoor", "category", "feature_type")
# What a sign says, the number before the name.
TEXTS = ("roomnumber", "ref", "name")
LEVELS = ("level", "level_id", "floor")
DOORS = {"door", "opening"}
# Kinds that bear no sign of their own, whatever name the drawing gives them.
NO_ROOMS = {"wall", "window", "building_outline", "level", "venue", "building", "inaccessible_space", "column", *DOORS}
NO_ROOMS |= {"footprint", "geofence"}
# The features that an IMDF archive has in files of their own, beside `unit.geojson`.
BESIDE = ("level", "opening")
UUID = re.compile("[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", re.IGNORECASE)
DEGREES = re.compile(r"CRS84|EPSG:+(4326|4258|4269|4979)\b", re.IGNORECASE)

Feature = dict[str, Any]


def read_geojson(path: Path, level: str | None, language: str = "") -> Plan:
    """Read a floor, or several where features say theirs."""
    plan = Plan(path.name)
    features = _features(path, plan)
    there = {feature.get("feature_type") for feature in features}
    for beside in (path.with_name(f"{kind}.geojson") for kind in BESIDE if kind not in there):
        features += _features(beside, plan) if beside.exists() and any("level_id" in one for one in features) else []
    language = _language(path, plan, features, language)
    names = _names(features, language)
    floors: dict[str, tuple[list[Room], list[Point]]] = {}
    metres = metres_of((place for feature in features for place in feature["outline"]), plan.source)
    for feature in features:
        outline, text = [metres(*place) for place in feature["outline"]], _first(feature, TEXTS, language)
        kinds = {words(feature.get(key)).lower() for key in KINDS}
        is_room = bool(text) and not kinds & NO_ROOMS
        for floor in _floors(feature, names) if outline else ():
            rooms, doors = floors.setdefault(floor, ([], []))
            if kinds & DOORS or feature.get("door") not in (None, "no"):
                doors.append(centre(outline))
            if is_room:
                rooms.append(Room(text, outline if len(outline) > 1 else outline * 2))
        if is_room and not outline:
            plan.left_out.add(text, "no places that can be read")
    told = [floor for floor, (rooms, _) in floors.items() if floor and rooms]
    for floor, (rooms, doors) in floors.items():
        # --level picks one of several floors, and names the only one.
        name = level if level and (not floor or len(told) < 2) else floor or path.stem
        if UUID.fullmatch(name) and rooms:
            plan.assumed.append(f"nothing tells the name of level {name}: put level.geojson beside it, or name it with --level")
        if level in (None, name):
            add_rooms(plan, name, rooms, doors)
    return plan


def _features(path: Path, plan: Plan) -> list[Feature]:
    """Return the properties of a file's features, with their other members and the outline that can be read."""
    try:
        collection = json.loads(text_of(path, FORM))
        listed, system = list(collection["features"]), json.dumps(collection.get("crs"))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise not_a(FORM, path) from error
    if system != "null" and not DEGREES.search(system):
        raise RevisitError(f"{path}: its places are in {system}, not in degrees: {REPROJECT}")
    features = []
    for number, feature in enumerate(listed, 1):
        with plan.left_out.unless(f"{path.name}, feature {number}", "it cannot be read"):
            members = {key: feature[key] for key in ("id", "feature_type") if key in feature}
            outline = _outline(feature["geometry"]) if feature.get("geometry") else []
            features.append({**(feature.get("properties") or {}), **members, "outline": outline})
    return features


def _language(path: Path, plan: Plan, features: list[Feature], asked: str) -> str:
    """Return the language of the names: the one asked for, the manifest's, or the first that is there."""
    found = list(dict.fromkeys(tag for feature in features for key in TEXTS for tag in texts_by_language(feature.get(key))))
    language = asked or "".join(found[:1])
    with contextlib.suppress(RevisitError, ValueError, LookupError, TypeError):
        language = asked or words(json.loads(text_of(path.with_name("manifest.json")))["language"]) or language
    if len(found) > 1 and asked not in found:
        plan.assumed.append(f"of names in {', '.join(found)} those in {language} are taken, else the first: --language LANG")
    return language


def _names(features: list[Feature], language: str) -> dict[str, str]:
    """Return the name of each level of IMDF, by its id; where two floors have one name, with the ordinal."""
    names: dict[str, str] = {}
    ordinals: dict[str, str] = {}
    for level in (feature for feature in features if feature.get("feature_type") == "level"):
        name, ordinal = _first(level, ("short_name", "name", "ordinal"), language), words(level.get("ordinal"))
        is_taken = ordinals.setdefault(name, ordinal) != ordinal
        names[words(level.get("id"))] = f"{name}.{ordinal}" if is_taken else name
    return names


def _floors(feature: Feature, names: dict[str, str]) -> list[str]:
    """Return the floors that a feature says it is on; nothing, in a list, where it says none."""
    said = next((feature[key] for key in LEVELS if feature.get(key) not in (None, "", [])), "")
    floors = [words(floor) for floor in (said if isinstance(said, list) else words(said).split(";"))]
    return [names.get(floor) or floor for floor in floors]


def _first(feature: Feature, keys: Sequence[str], language: str) -> str:
    return next(filter(None, (words(feature.get(key), language) for key in keys)), "")


def _outline(geometry: dict[str, Any]) -> list[Point]:
    """Return the outer ring of a polygon, the first of several, or the places of a line or a point."""
    places = geometry["coordinates"]
    depth = {"Point": 0, "LineString": 1, "MultiPoint": 1, "Polygon": 2, "MultiLineString": 2, "MultiPolygon": 3}
    for _ in range(depth[geometry["type"]] - 1):
        places = places[0]
    if geometry["type"] == "Point":
        places = [places]
    outline = [(float(place[0]), float(place[1])) for place in places]
    if not outline or not all(math.isfinite(x) and math.isfinite(y) for x, y in outline):
        raise ValueError("no places")
    return outline
