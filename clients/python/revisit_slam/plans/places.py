"""Geometry along the floor: local metres, centres, and the doors of a room."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Sequence

from ..errors import RevisitError
from .plan import Point

REPROJECT = "`ogr2ogr -s_srs EPSG:CODE -t_srs EPSG:4326 NEW OLD` makes them of metres"
EARTH_RADIUS_M = 6_378_137.0
# A door drawn as a gap or a leaf of the wall is this near to its room's outline, in metres.
DOOR_NEAR_M = 0.6
# What is further from the middle is no part of the plan: about 11 km.
FAR_DEG = 0.1


def metres_of(places: Iterable[Point], source: str) -> Callable[[float, float], Point]:
    """Return what makes metres of longitude and latitude, east and north of the south-western corner of places in degrees.

    They are metres as on a plane that touches the earth there, which is fine within a campus.

    Raises:
        RevisitError: They are no degrees.
    """
    listed = list(places) or [(0.0, 0.0)]
    middle = statistics.median(place[0] for place in listed), statistics.median(place[1] for place in listed)
    if not (abs(middle[0]) <= 180 and abs(middle[1]) <= 90):
        told = f"places like {middle[0]:g}, {middle[1]:g} are no degrees of longitude and latitude"
        raise RevisitError(f"{source}: {told}: {REPROJECT}")
    # One place elsewhere, as at 0, 0, moves no other.
    near = [place for place in listed if math.dist(place, middle) < FAR_DEG] or listed
    west, south = min(place[0] for place in near), min(place[1] for place in near)
    north_m = math.radians(1) * EARTH_RADIUS_M
    east_m = north_m * math.cos(math.radians(south))
    return lambda longitude, latitude: ((longitude - west) * east_m, (latitude - south) * north_m)


def centre(outline: Sequence[Point]) -> Point:
    """Return the middle of an outline's bounding box."""
    xs, ys = [place[0] for place in outline], [place[1] for place in outline]
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def doors_of(outline: Sequence[Point], doors: Iterable[Point]) -> list[Point]:
    """Return the doors that lie in a room's outline, whose ends need not meet."""
    walls = list(zip(outline, outline[1:]))
    return [door for door in doors if min(_from_segment(door, *wall) for wall in walls) <= DOOR_NEAR_M]


def outward(door: Point, outline: Sequence[Point]) -> Point | None:
    """Return the unit vector out of a room through one of its doors: the sign beside it is read from there."""
    a, b = min(zip(outline, outline[1:]), key=lambda wall: _from_segment(door, *wall))
    along = (b[0] - a[0], b[1] - a[1])
    length = math.hypot(*along)
    if length == 0:
        return None
    normal = (along[1] / length, -along[0] / length)
    step = (door[0] + normal[0] * DOOR_NEAR_M * 1.5, door[1] + normal[1] * DOOR_NEAR_M * 1.5)
    return (-normal[0], -normal[1]) if _contains(outline, step) else normal


def _from_segment(place: Point, a: Point, b: Point) -> float:
    along = (b[0] - a[0], b[1] - a[1])
    squared = along[0] ** 2 + along[1] ** 2
    share = 0.0
    if squared > 0:
        share = ((place[0] - a[0]) * along[0] + (place[1] - a[1]) * along[1]) / squared
    share = min(1.0, max(0.0, share))
    return math.hypot(place[0] - a[0] - share * along[0], place[1] - a[1] - share * along[1])


def _contains(outline: Sequence[Point], place: Point) -> bool:
    inside = False
    for (ax, ay), (bx, by) in zip(outline, outline[1:]):
        crosses = (ay > place[1]) != (by > place[1])
        if crosses and place[0] < ax + (place[1] - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside
