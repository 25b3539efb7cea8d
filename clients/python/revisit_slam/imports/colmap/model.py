"""COLMAP model: poses, cameras and points of a sparse reconstruction.

pycolmap reads a model as a whole, into several times its size. Here the files are read piece by piece; pycolmap tells
what the numbers of a camera mean, and tests hold the reading against its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np

from ...errors import RevisitError
from ...needed import needed
from ...pixels.ids import ids_of_names
from ...pixels.stamps import named_time_ns
from ..damage import Account, told_of
from ..observation import NO_POINT, SECOND_NS, Observation
from ..opened import Opened, Wanted
from ..point_store import PointStore
from ..poses import checked, inverse, matrix
from .binary import BinaryModel
from .cameras import Camera
from .database import NO_FEATURES, Pairs
from .image import Image
from .text import TextModel

FILES = ("cameras", "images", "points3D")
FORMS: dict[str, type[BinaryModel] | type[TextModel]] = {"bin": BinaryModel, "txt": TextModel}


def form_of(model: Path) -> str:
    """Return the ending of a model's files."""
    for form in FORMS:
        if all((model / f"{name}.{form}").is_file() for name in FILES):
            return form
    raise RevisitError(f"{model}: no COLMAP model in it ({', '.join(FILES)}, .bin or .txt)")


def open_map(model: Path, wanted: Wanted) -> Opened:
    """Open a model's folder."""
    form = form_of(model)
    needed("pycolmap")
    account = Account(model)
    account.notes.append(NO_FEATURES)
    if wanted.metres_per_unit is None:
        account.notes.append("a COLMAP model has no unit: the map is not metric; --metres-per-unit tells it")
    return Opened("COLMAP model", wanted.metres_per_unit is not None, lambda: _keyframes(model, form, wanted, account), account)


def _keyframes(model: Path, form: str, wanted: Wanted, account: Account) -> Iterator[Observation]:
    with (
        told_of(model, "the reader of COLMAP models"),
        closing(FORMS[form](model)) as files,
        PointStore(account) as points,
    ):
        cameras = files.cameras(account)
        images = sorted(files.images(), key=lambda image: image.name)
        ids = ids_of_names(image.name for image in images)
        stamps = _stamps(images, account.notes)
        _tell_of_cameras(cameras, account.notes)
        pairs = Pairs(wanted.database, account) if wanted.database else None
        # Earlier ones only are named; images are read in order of time.
        earlier: dict[str, str] = {}
        scale, session = wanted.metres_per_unit or 1.0, wanted.name(model)
        for id, x, y, z in files.points():
            points.add(id, x * scale, y * scale, z * scale)
        if points.are_far:
            account.notes.append("ids of points are none that the server takes: points are numbered in the order of the file")
        for image in sorted(images, key=lambda image: (stamps[image.name], image.name)):
            with account.part(f"image {image.name}") as where:
                if image.name in earlier:
                    raise RevisitError(f"{where} is in it twice")
                if image.camera not in cameras:
                    raise RevisitError(f"{where} is of camera {image.camera}, which the model does not have")
                observed = files.observed(image)
                # A point that an image observes twice counts once.
                found = points.find(np.unique(observed[observed != NO_POINT]).tolist(), where)
                seen = Observation(
                    ids[image.name], session, stamps[image.name], _pose(image, scale, where), cameras[image.camera].pinhole,
                    observes=list(found), covisible=pairs.earlier(image.name, earlier) if pairs else None,
                )  # fmt: skip
                seen.placed.update(points.new_of(found))
                earlier[image.name] = seen.id
                yield seen
        if points.count > points.seen:
            account.notes.append(f"{points.count - points.seen} of {points.count} points are observed by no image, and are left out")
        if pairs and pairs.unknown:
            account.notes.append(f"{pairs.unknown} of the model's images are not in {wanted.database}")


def _pose(image: Image, scale: float, where: str) -> np.ndarray:
    """Return where an image was taken: COLMAP keeps `camera_from_world`, and the real part of a quaternion first."""
    w, x, y, z = image.wxyz
    world_from_camera = inverse(matrix(image.camera_from_world, (x, y, z, w), where))
    world_from_camera[:3, 3] = checked(world_from_camera[:3, 3] * scale, where)
    return world_from_camera


def _stamps(images: list[Image], notes: list[str]) -> dict[str, int]:
    """Return the time of each image: what its name tells, or one a second where any name is no time."""
    named = {image.name: named_time_ns(Path(image.name).stem) for image in images}
    told = {name: stamp_ns for name, stamp_ns in named.items() if stamp_ns is not None}
    # 0001.jpg and the like are numbers: times have a unit that their digits tell, or a point.
    if len(told) == len(images) and all("." in Path(name).stem or len(Path(name).stem) > 9 for name in told):
        return told
    notes.append("no times in the names of the images: they are taken as a second apart, in order of their names")
    return {image.name: (number + 1) * SECOND_NS for number, image in enumerate(images)}


def _tell_of_cameras(cameras: dict[int, Camera], notes: list[str]) -> None:
    if any(camera.distorts for camera in cameras.values()):
        notes.append("cameras that distort become the pinhole with the same focal lengths: undistort what is sent beside it")
    if any(camera.pinhole is None for camera in cameras.values()):
        notes.append("images that see all around have no camera")
