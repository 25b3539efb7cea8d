"""EuRoC: a sequence of the EuRoC MAV dataset (Burri et al., IJRR 2016), or another in its ASL format; its left camera."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ...files import numbered_rows_of, text_of
from ...needed import needed
from ..camera import Calibration
from ..trajectory import Trajectory, read_tum
from .source import Source, every, listed

# The first of these that is there tells where the body was.
GROUND_TRUTHS = ("state_groundtruth_estimate0", "mocap0", "vicon0")


def open_euroc(folder: Path, trajectory: Trajectory | None, every_s: float) -> Source:
    """Open a sequence: `cam0`, and its ground truth where it is there. A trajectory given instead is the camera's."""
    mav = folder / "mav0" if (folder / "mav0").is_dir() else folder
    camera = mav / "cam0"
    calibration, body_from_camera = _sensor(camera / "sensor.yaml")
    source = Source([], str(folder))
    rows, known = numbered_rows_of(camera / "data.csv"), {"video": folder.resolve().name, "calibration": calibration}
    pictures = listed(camera / "data.csv", camera / "data", "nanoseconds,file", rows, int, source.left_out)
    source = replace(source, frames=every([replace(frame, **known) for frame in pictures], every_s))
    if trajectory is not None:
        return source.along(trajectory)
    for name in GROUND_TRUTHS:
        if (mav / name / "data.csv").exists():
            return source.along(*_ground_truth(mav / name, body_from_camera))
    return source


def _ground_truth(sensor: Path, body_from_camera: np.ndarray) -> tuple[Trajectory, str, np.ndarray]:
    """Return where the sensor was, what that is, and where the camera sits on it."""
    file, sensor_from_body = sensor / "data.csv", np.eye(4)
    if (sensor / "sensor.yaml").exists():
        sensor_from_body = np.linalg.inv(_transform(_yaml(sensor / "sensor.yaml"), sensor / "sensor.yaml"))
    # Their order of a quaternion is not that of files that name no columns.
    if re.match(r"\W*[a-z]", text_of(file, "an EuRoC ground truth"), re.IGNORECASE) is None:
        raise RevisitError(f"{file}: its first line must name the columns: #timestamp [ns], p_x [m], .., q_w, q_x, q_y, q_z")
    return read_tum(file), f"the ground truth of {sensor.name}", sensor_from_body @ body_from_camera


def _sensor(path: Path) -> tuple[Calibration, np.ndarray]:
    sensor = _yaml(path)
    try:
        fx, fy, cx, cy = (float(value) for value in sensor["intrinsics"])
        distortion = tuple(float(value) for value in sensor.get("distortion_coefficients", ()))
        model = str(sensor.get("distortion_model", "radial-tangential"))
        width, height = (int(value) for value in sensor["resolution"])
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise RevisitError(f"{path}: needs intrinsics (fu, fv, cu, cv), distortion_coefficients and resolution") from error
    if model not in ("radial-tangential", "radtan", "plumb_bob", "equidistant", "none"):
        raise RevisitError(f"{path}: distortion_model {model} is not known (radial-tangential, equidistant)")
    terms = distortion if model != "none" else ()
    calibration = Calibration.read(path, fx, fy, cx, cy, terms, model == "equidistant", (width, height))
    return calibration, _transform(sensor, path)


def _transform(sensor: dict[str, Any], path: Path) -> np.ndarray:
    """Return T_BS: the body's frame from the sensor's."""
    try:
        matrix = np.array(sensor["T_BS"]["data"], float).reshape(4, 4)
    except (KeyError, TypeError, ValueError) as error:
        raise RevisitError(f"{path}: needs T_BS, sixteen numbers under `data`") from error
    turn = matrix[:3, :3]
    rigid = np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) and np.linalg.det(turn) > 0
    if not rigid or not np.isfinite(matrix).all() or not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise RevisitError(f"{path}: T_BS is no rotation and translation, row by row")
    return matrix


def _yaml(path: Path) -> dict[str, Any]:
    yaml = needed("yaml", "pyyaml")
    try:
        # OpenCV writes a first line that other readers do not take.
        read = yaml.safe_load("\n".join(line for line in text_of(path, "YAML").splitlines() if not line.startswith("%")))
    except yaml.YAMLError as error:
        raise RevisitError(f"{path}: not YAML") from error
    if not isinstance(read, dict):
        raise RevisitError(f"{path}: no fields in it")
    return read
