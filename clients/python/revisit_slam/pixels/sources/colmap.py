"""COLMAP: a sparse model (Schönberger and Frahm, CVPR 2016): poses, cameras and the points that each image observes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ...imports.colmap.cameras import HALF_PX
from ...imports.colmap.model import form_of
from ...left_out import LeftOut
from ...needed import needed
from ..camera import Calibration
from ..frames import Frame, Landmarks, frames_of
from .source import Source, there

# Where each model has its focal lengths (one or two), and where its distortion begins; the centre stands between.
SIMPLE = {"SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE"}
DOUBLE = {"PINHOLE", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV"}


def open_colmap(model: Path, images: Path | None, metres_per_unit: float | None) -> Source:
    """Open a model; its pictures lie in `images`, or in a folder of that name beside or around it."""
    form_of(model)
    pycolmap = needed("pycolmap")
    try:
        reconstruction = pycolmap.Reconstruction(str(model))
    except Exception as error:  # It raises types of its own.
        raise RevisitError(f"{model}: pycolmap cannot read the model: {str(error).splitlines()[0]}") from error
    folder = images or _beside(model)
    if not folder.is_dir():
        raise RevisitError(f"{folder}: no such folder")
    absolute = [image.name for image in reconstruction.images.values() if Path(image.name).is_absolute()]
    if absolute:
        raise RevisitError(f"{model}: image {absolute[0]} is named by where it lay; names within the images' folder are read")
    left_out = LeftOut()
    found = {folder / image.name: image for image in reconstruction.images.values() if image.has_pose}
    for image in reconstruction.images.values():
        if not image.has_pose:
            left_out.add(image.name, "the model has no pose of it")
    pictures = there(frames_of(found, folder), left_out)
    if not pictures:
        raise RevisitError(f"{folder}: none of the model's {len(found)} images is in it; --images names their folder")
    scale = metres_per_unit or 1.0
    return Source(
        [_frame(frame, found[frame.path], reconstruction, model.resolve().name, scale) for frame in pictures],
        str(model),
        "the model's",
        "those of the model's points" + ("" if metres_per_unit else ", in a unit that nobody knows"),
        metric=metres_per_unit is not None,
        left_out=left_out,
    )


def _beside(model: Path) -> Path:
    for parent in model.resolve().parents[:3]:
        if (parent / "images").is_dir():
            return parent / "images"
    raise RevisitError(f"{model}: no folder `images` near it; --images names their folder")


def _frame(frame: Frame, image: Any, reconstruction: Any, session: str, scale: float) -> Frame:
    calibration = _calibration(reconstruction.cameras[image.camera_id])
    camera_from_world = np.eye(4)
    camera_from_world[:3] = image.cam_from_world().matrix()
    pose = np.linalg.inv(camera_from_world)
    pose[:3, 3] *= scale
    # A point that an image observes twice counts once.
    observed = {point.point3D_id: point.xy for point in image.points2D if point.has_point3D()}
    ids = sorted(observed)
    pixels = np.array([observed[id] for id in ids]).reshape(-1, 2) - HALF_PX
    positions = np.array([reconstruction.points3D[id].xyz for id in ids]).reshape(-1, 3) * scale
    landmarks = Landmarks(np.array(ids, np.int64), calibration.undistorted_pixels(pixels), positions)
    return replace(frame, session_from_camera=pose, session=session, calibration=calibration, landmarks=landmarks)


def _calibration(camera: Any) -> Calibration:
    model, values = camera.model.name, [float(value) for value in camera.params]
    if model in SIMPLE:
        fx, fy, (cx, cy), distortion = values[0], values[0], values[1:3], values[3:]
    elif model in DOUBLE:
        fx, fy, (cx, cy), distortion = values[0], values[1], values[2:4], values[4:]
    else:
        raise RevisitError(f"camera model {model} is not known here: {', '.join(sorted(SIMPLE | DOUBLE))}; undistort the images first")
    # OpenCV's lists have four terms at least; the models that lack some mean zeros.
    distortion += [0.0] * (4 - len(distortion) if distortion else 0)
    fisheye, size = model.endswith("FISHEYE"), (camera.width, camera.height)
    where = f"camera {camera.camera_id} of the model"
    return Calibration.read(where, fx, fy, cx - HALF_PX, cy - HALF_PX, tuple(distortion), fisheye, size)
