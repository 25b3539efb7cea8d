"""Cameras of COLMAP as undistorted pinholes."""

from __future__ import annotations

from typing import Any, NamedTuple

from ...errors import RevisitError
from ...needed import needed
from ...pixels.pinhole import Pinhole

# COLMAP counts pixels from the corner of the first one, the API from its middle.
HALF_PX = 0.5


class Camera(NamedTuple):
    """A camera: its pinhole, None for one that sees all around, and whether it distorts."""

    pinhole: Pinhole | None
    distorts: bool


def parameter_count(model: int | str, where: str) -> int:
    """Return how many numbers a camera model has."""
    return len(_camera(model, where).params)


def camera_of(model: int | str, width: int, height: int, params: list[float], where: str) -> Camera:
    """Return a camera by the numbers of its model."""
    camera = _camera(model, where)
    if len(params) != len(camera.params):
        raise RevisitError(f"{where}: {len(params)} numbers; a {camera.model.name} has {len(camera.params)}")
    if camera.model.name == "EQUIRECTANGULAR":
        return Camera(None, False)
    camera.width, camera.height, camera.params = width, height, params
    found = Pinhole(
        camera.focal_length_x, camera.focal_length_y,
        camera.principal_point_x - HALF_PX, camera.principal_point_y - HALF_PX, width, height,
    )  # fmt: skip
    return Camera(found.checked(where), not camera.is_undistorted())


def _camera(model: int | str, where: str) -> Any:
    pycolmap = needed("pycolmap")
    try:
        known = pycolmap.CameraModelId(model) if isinstance(model, int) else pycolmap.CameraModelId.__members__[model]
        # Any focal length and size: only the model counts.
        return pycolmap.Camera.create_from_model_id(1, known, 1.0, 2, 2)
    except (KeyError, ValueError, TypeError) as error:
        raise RevisitError(f"{where}: camera model {model} is not known to pycolmap {pycolmap.__version__}") from error
