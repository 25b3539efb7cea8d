"""EuRoC: a sequence of the EuRoC MAV dataset (Burri et al., IJRR 2016), or another in its ASL format; its left camera."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ...files import numbered_rows_of, text_of
from ...left_out import LeftOut
from ..camera import Calibration
from ..frames import Frame
from ..ids import ids_of
from ..trajectory import Trajectory
from ...needed import needed
from .source import Source, every, there

# The first of these that is there tells where the body was.
GROUND_TRUTHS = ("state_groundtruth_estimate0", "mocap0", "vicon0")


def open_euroc(folder: Path, trajectory: Trajectory | None, every_s: float) -> Source:
    """Open a sequence: `cam0`, and its ground truth where it is there. A trajectory given instead is the camera's."""
    mav = folder / "mav0" if (folder / "mav0").is_dir() else folder
    camera = mav / "cam0"
    calibration, body_from_camera = _sensor(camera / "sensor.yaml")
    left_out = LeftOut()
    pictures = there(_pictures(camera, folder, left_out), left_out)
    frames = every([replace(frame, calibration=calibration) for frame in pictures], every_s)
    source = Source(frames, str(folder), left_out=left_out)
    if trajectory is not None:
        return source.along(trajectory)
    for name in GROUND_TRUTHS:
        if (mav / name / "data.csv").exists():
            return source.along(_ground_truth(mav / name, body_from_camera), f"the ground truth of {name}")
    return source


def _pictures(camera: Path, folder: Path, left_out: LeftOut) -> list[Frame]:
    frames = []
    for number, row in numbered_rows_of(camera / "data.csv", "an EuRoC list of `nanoseconds,file`"):
        try:
            stamp_ns, path = int(row[0]), camera / "data" / row[1]
        except (ValueError, IndexError):
            left_out.add(f"{camera / 'data.csv'}, line {number}", "no row of `nanoseconds,file`")
            continue
        frames.append(Frame("", path, folder.resolve().name, number, stamp_ns))
    ids = ids_of((frame.path for frame in frames), camera / "data")
    frames = [replace(frame, id=ids[frame.path]) for frame in frames]
    return sorted(frames, key=lambda frame: frame.stamp_ns or 0)


def _ground_truth(sensor: Path, body_from_camera: np.ndarray) -> Trajectory:
    """Read `nanoseconds, x, y, z, qw, qx, qy, qz` of the sensor, and return where the camera was."""
    sensor_from_body = np.eye(4)
    if (sensor / "sensor.yaml").exists():
        sensor_from_body = np.linalg.inv(_transform(_yaml(sensor / "sensor.yaml"), sensor / "sensor.yaml"))
    poses, left_out = [], LeftOut()
    for number, row in numbered_rows_of(sensor / "data.csv", "an EuRoC ground truth"):
        try:
            stamp_ns, values = int(row[0]), np.array([float(value) for value in row[1:8]])
            if len(values) != 7 or not np.isfinite(values).all() or np.linalg.norm(values[3:]) < 1e-6:
                raise ValueError
        except (ValueError, IndexError):
            left_out.add(f"line {number}", "no pose of a time and seven numbers")
            continue
        poses.append((stamp_ns, values[:3], np.roll(values[3:], -1)))
    return Trajectory(str(sensor / "data.csv"), poses, sensor_from_body @ body_from_camera, left_out=left_out)


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
