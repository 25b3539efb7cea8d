"""Cameras of stella_vslam, which undistorts its keypoints into the pinhole of the same focal lengths."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from ...errors import RevisitError
from ...pixels.pinhole import Pinhole
from ..damage import Account
from ..observation import Observation
from ..opened import Opened, Wanted

PINHOLES = ("Perspective", "Fisheye", "RadialDivision")
ALL_AROUND = "Equirectangular"
SETUPS = ("Monocular", "Stereo", "RGBD")


class Camera(NamedTuple):
    """A camera: its pinhole, None for one that sees all around, and whether it measures lengths."""

    pinhole: Pinhole | None
    metric: bool


def camera_of(told: Mapping[str, Any], where: str) -> Camera:
    """Return the camera that the columns or keys of a file tell."""
    model, setup = told["model_type"], told["setup_type"]
    if setup not in SETUPS:
        raise RevisitError(f"{where}: setup {setup!r} is not known: {', '.join(SETUPS)}")
    if model == ALL_AROUND:
        return Camera(None, setup != "Monocular")
    if model not in PINHOLES:
        raise RevisitError(f"{where}: camera model {model!r} is not known: {', '.join((*PINHOLES, ALL_AROUND))}")
    numbers = [told[name] for name in ("fx", "fy", "cx", "cy", "cols", "rows")]
    if any(isinstance(number, bool) or not isinstance(number, (int, float)) for number in numbers):
        raise RevisitError(f"{where}: its focal lengths, centre and size are no numbers")
    fx, fy, cx, cy = (float(number) for number in numbers[:4])
    return Camera(Pinhole(fx, fy, cx, cy, int(numbers[4]), int(numbers[5])).checked(where), setup != "Monocular")


def opened(cameras: Mapping[str, Camera], wanted: Wanted, keyframes: Callable[[], Iterator[Observation]], account: Account) -> Opened:
    """Return a map of these cameras, with what a person should know of them."""
    # A camera alone measures no length; two cameras or depths do.
    metric = wanted.metres_per_unit is not None or all(camera.metric for camera in cameras.values())
    if not metric:
        account.notes.append("one camera measures no length: the map is not metric; --metres-per-unit tells it")
    if any(camera.pinhole is None for camera in cameras.values()):
        account.notes.append("pictures that show all around have no camera and no features: points only")
    return Opened("stella_vslam map", metric, keyframes, account)
