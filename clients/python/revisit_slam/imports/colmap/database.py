"""COLMAP database: which images match which, as declared covisibility. Its SIFT descriptors are not read: no Hamming
distance compares them.

It is read with SQLite, for reading only: pycolmap changes a file of an older version when it opens it. pycolmap tells
which images a pair is of, and what the numbers of a camera mean.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ...needed import needed
from ...pixels.ids import ids_of_names, plain_id
from ..damage import Account
from ..limits import MAX_KEYFRAMES
from ..observation import SECOND_NS, Observation
from ..opened import Opened, Wanted
from ..poses import inverse, matrix
from ..sqlite_file import need_columns, reading
from .cameras import camera_of

TABLES = {
    "cameras": ("camera_id", "model", "width", "height", "params"),
    "images": ("image_id", "name", "camera_id"),
    "two_view_geometries": ("pair_id", "rows"),
}
PRIOR = tuple(f"prior_{part}" for part in ("qw", "qx", "qy", "qz", "tx", "ty", "tz"))
NO_FEATURES = "SIFT features are left out, no Hamming distance compares them: without words, nothing proposes a loop"
# COLMAP's and ORB-SLAM's own: fewer inliers join no two images.
MIN_INLIERS = 15
# A pair's number holds both images'; COLMAP numbers images below it.
MAX_IMAGE_ID = 2**31 - 1


class Pairs:
    """Verified pairs of images of a database, by name."""

    def __init__(self, path: Path, account: Account) -> None:
        self._ids: dict[str, int] = {}
        self._names: dict[int, str] = {}
        self.unknown = 0
        need_columns(path, TABLES, "database of COLMAP")
        needed("pycolmap")
        with reading(path) as connection:
            for id, name in connection.execute("select image_id, name from images"):
                self._ids[str(name)], self._names[id] = id, str(name)
                if len(self._ids) > MAX_KEYFRAMES:
                    raise RevisitError(f"{path}: it has more than {MAX_KEYFRAMES} images; so many are not taken")
            self._neighbours: dict[int, dict[int, int]] = {}
            rows = connection.execute("select pair_id, rows from two_view_geometries where rows >= ?", (MIN_INLIERS,))
            for pair, inliers in rows:
                with account.part(f"pair {pair}") as where:
                    first, second = self._images(pair, where)
                    self._neighbours.setdefault(first, {})[second] = int(inliers)
                    self._neighbours.setdefault(second, {})[first] = int(inliers)

    def earlier(self, name: str, known: dict[str, str]) -> dict[str, int]:
        """Return the keyframes among the known ones that an image matches, and by how many inliers."""
        id = self._ids.get(name)
        if id is None:
            self.unknown += 1
            return {}
        others = self._neighbours.get(id, {})
        return {known[self._names[other]]: inliers for other, inliers in others.items() if self._names[other] in known}

    def _images(self, pair: Any, where: str) -> tuple[int, int]:
        if not isinstance(pair, int) or not 0 <= pair < MAX_IMAGE_ID * (MAX_IMAGE_ID + 1):
            raise RevisitError(f"{where} is no number of two images")
        first, second = needed("pycolmap").pair_id_to_image_pair(pair)
        for id in (first, second):
            if id not in self._names:
                raise RevisitError(f"{where} is of image {id}, which is not in it")
        return first, second


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a database by itself: cameras, matches, and prior poses where there are any."""
    has_priors = set(PRIOR) <= need_columns(path, TABLES, "database of COLMAP")["images"]
    account = Account(path)
    metric = wanted.metres_per_unit is not None
    return Opened("COLMAP database", metric, lambda: _keyframes(path, has_priors, wanted, account), account)


def _keyframes(path: Path, has_priors: bool, wanted: Wanted, account: Account) -> Iterator[Observation]:
    pairs, without = Pairs(path, account), 0
    earlier: dict[str, str] = {}
    session = wanted.name(path)
    with reading(path) as connection:
        cameras = {}
        for id, model, width, height, params in connection.execute("select camera_id, model, width, height, params from cameras"):
            with account.part(f"camera {id}") as where:
                if {type(model), type(width), type(height)} != {int} or not isinstance(params, bytes) or len(params) % 8:
                    raise RevisitError(f"{where}: its model, size and parameters are of another kind")
                cameras[id] = camera_of(model, width, height, list(np.frombuffer(params, "<f8")), where).pinhole
        ids = ids_of_names(str(name) for (name,) in connection.execute("select name from images"))
        columns = ", ".join(("name", "camera_id", *PRIOR)) if has_priors else "name, camera_id"
        for number, (name, camera, *prior) in enumerate(connection.execute(f"select {columns} from images order by name"), 1):
            with account.part(f"image {name}") as where:
                if camera not in cameras:
                    raise RevisitError(f"{where} is of camera {camera}, which is not in it")
                pose = _prior(prior, wanted.metres_per_unit or 1.0, where)
                if str(name) in earlier:
                    raise RevisitError(f"{where} is in it twice")
                seen = Observation(
                    # What nothing places against the others is a session of its own: none of its distances mean anything.
                    ids[str(name)], session if pose is not None else plain_id(f"{session}-{number}"), number * SECOND_NS,
                    np.eye(4) if pose is None else pose, cameras[camera], covisible=pairs.earlier(str(name), earlier),
                )  # fmt: skip
                without += pose is None
                earlier[str(name)] = seen.id
                yield seen
    if without:
        account.notes.append(
            f"{without} images have no prior pose: each is a session of its own, at its origin; a model has poses "
            f"(revisit-play import MODEL --database {path.name})"
        )
    account.notes.append("no times in a database: images are taken as a second apart, in order of their names")
    account.notes.append(NO_FEATURES)


def _prior(numbers: list[Any], scale: float, where: str) -> np.ndarray | None:
    """Return `world_from_camera` of a prior `camera_from_world`; None where there is none."""
    if len(numbers) != len(PRIOR) or any(not isinstance(number, (int, float)) for number in numbers) or not np.isfinite(numbers).all():
        return None
    w, x, y, z, *translation = (float(number) for number in numbers)
    if not any((w, x, y, z)):
        return None
    pose = inverse(matrix(translation, (x, y, z, w), where))
    pose[:3, 3] *= scale
    return pose
