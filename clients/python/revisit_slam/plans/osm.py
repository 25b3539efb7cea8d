"""OpenStreetMap's Simple Indoor Tagging (`.osm`): rooms as ways with `indoor=room`, doors as nodes of their outlines."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from ..errors import RevisitError
from ..files import not_a, text_of
from .places import metres_of
from .plan import Plan, Point
from .rooms import Room, add_rooms

FORM = "a file of OpenStreetMap's XML"
ROOMS = ("room", "area", "corridor")
# A way that is on more floors than this is a shaft.
LEVELS_MAX = 64


def read_osm(path: Path, level: str | None, language: str = "") -> Plan:
    """Read the rooms and doors of a building's floors; what was deleted is not there."""
    plan = Plan(path.name)
    try:
        root = ElementTree.fromstring(text_of(path, FORM))
    except ElementTree.ParseError as error:
        raise not_a(FORM, path) from error
    if root.tag != "osm":
        raise RevisitError(f"{path}: not {FORM}, but of `{root.tag}`: save it as `.osm`, as JOSM does")
    nodes, places = _there(root, "node"), {}
    for id, node in nodes.items():
        with plan.left_out.unless(f"node {id}", "it has no place"):
            place = float(node.attrib["lon"]), float(node.attrib["lat"])
            places |= {id: place} if abs(place[0]) <= 180 and abs(place[1]) <= 90 else {}
    metres = metres_of(places.values(), plan.source)
    floors: dict[str, tuple[list[Room], list[Point]]] = {}
    untold = 0
    for tags, refs in _shapes(root, plan):
        # What a sign says: the number before the name.
        text = next((tags[key] for key in ("ref", f"name:{language}", "name") if tags.get(key)), "")
        is_room, members = bool(text) and tags.get("indoor") in ROOMS, [ref for ref in refs if ref in places]
        for ref in (ref for ref in refs if is_room and ref not in places):
            plan.left_out.add(f"node {ref} of {text}", "it is not in the file")
        untold += is_room and "level" not in tags
        for floor in levels(";".join((tags.get("level") or level or "0", tags.get("repeat_on", "")))):
            rooms, doors = floors.setdefault(floor, ([], []))
            doors += [metres(*places[member]) for member in members if _is_door(_tags(nodes[member]), floor)]
            if is_room and len(members) > 2:
                rooms.append(Room(text, [metres(*places[member]) for member in members]))
    if untold:
        plan.assumed.append(f"{untold} rooms tell no level, and are taken for level {level or '0'}")
    for floor, (rooms, doors) in floors.items():
        if level is None or floor == level:
            add_rooms(plan, floor, rooms, sorted(set(doors)))
    return plan


def _there(root: ElementTree.Element, kind: str) -> dict[str, ElementTree.Element]:
    """Return the elements of a kind that are there, by id: none that is deleted; of several versions the last counts."""
    last = {element.get("id", ""): element for element in root.iter(kind)}
    return {id: one for id, one in last.items() if one.get("action") != "delete" and one.get("visible") != "false"}


def _shapes(root: ElementTree.Element, plan: Plan) -> Iterator[tuple[dict[str, str], list[str]]]:
    """Yield the tags and the nodes of each way, and of each room that is a relation with one outer way."""
    ways = _there(root, "way")
    refs = {id: [node.get("ref", "") for node in way.iter("nd")] for id, way in ways.items()}
    yield from ((_tags(way), refs[id]) for id, way in ways.items())
    for id, relation in _there(root, "relation").items():
        outer = [member.get("ref", "") for member in relation.iter("member") if member.get("role") != "inner"]
        if len(outer) == 1 and outer[0] in refs:
            yield _tags(relation), refs[outer[0]]
        elif _tags(relation).get("indoor") in ROOMS:
            plan.left_out.add(f"relation {id}", "a room of several outer ways: draw it as one")


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
