"""OpenStreetMap's Simple Indoor Tagging (`.osm`): rooms as ways with `indoor=room`, doors as nodes of their outlines."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ..errors import RevisitError
from .places import LocalMetres, origin_of
from .plan import Plan, Point
from .rooms import Room, add_rooms

ROOMS = ("room", "area", "corridor")
# What a sign says, the number before the name.
TEXTS = ("ref", "name")
# A way that is on more floors than this is a shaft.
LEVELS_MAX = 64


def read_osm(path: Path, level: str | None) -> Plan:
    """Read the rooms and doors of a building's floors."""
    try:
        root = ElementTree.parse(path).getroot()
        nodes = {node.attrib["id"]: node for node in root.iter("node")}
        places = {key: (float(node.attrib["lon"]), float(node.attrib["lat"])) for key, node in nodes.items()}
    except (ElementTree.ParseError, KeyError, ValueError) as error:
        raise RevisitError(f"{path}: not a file of OpenStreetMap's XML") from error
    plan = Plan(path.name)
    if not places:
        return plan
    metres = origin_of(places.values())
    floors: dict[str, tuple[list[Room], list[Point]]] = {}
    for way in root.iter("way"):
        tags = _tags(way)
        text = next((tags[key] for key in TEXTS if tags.get(key)), None)
        members = [member.attrib["ref"] for member in way.iter("nd") if member.attrib["ref"] in places]
        for floor in levels(tags.get("level", "0")):
            rooms, doors = floors.setdefault(floor, ([], []))
            doors += [_at(metres, places, member) for member in members if _is_door(_tags(nodes[member]), floor)]
            if text and tags.get("indoor") in ROOMS and len(members) > 2:
                rooms.append(Room(text, [_at(metres, places, member) for member in members]))
    for floor, (rooms, doors) in floors.items():
        if level is None or floor == level:
            add_rooms(plan, floor, rooms, sorted(set(doors)))
    return plan


def levels(tag: str) -> list[str]:
    """Return the floors of a `level` tag: `1`, `0;1` or a range `-1-2`."""
    found: list[str] = []
    for part in tag.split(";"):
        text = part.strip()
        low, dash, high = text[1:].partition("-") if text.startswith("-") else text.partition("-")
        low = f"-{low}" if text.startswith("-") else low
        try:
            ends = (int(low), int(high)) if dash else None
        except ValueError:
            ends = None
        if ends and 0 <= ends[1] - ends[0] < LEVELS_MAX:
            found += [str(floor) for floor in range(ends[0], ends[1] + 1)]
        elif text:
            found.append(text)
    return found


def _tags(element: ElementTree.Element) -> dict[str, str]:
    return {tag.attrib.get("k", ""): tag.attrib.get("v", "") for tag in element.iter("tag")}


def _is_door(tags: dict[str, str], floor: str) -> bool:
    is_door = tags.get("door", "no") != "no" or tags.get("indoor") == "door" or "entrance" in tags
    return is_door and ("level" not in tags or floor in levels(tags["level"]))


def _at(metres: LocalMetres, places: dict[str, Point], member: str) -> Point:
    return metres(*places[member])
