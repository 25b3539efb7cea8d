"""Recordings that `revisit-play import` wrote, read back for tests."""

from __future__ import annotations

import base64
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard

from revisit_slam.pixels.rotations import rotation
from revisit_slam.play import main


@dataclass(frozen=True)
class Imported:
    """A recording's map and keyframes, its loops, and what was told on standard error."""

    map: dict[str, Any]
    keyframes: dict[str, dict[str, Any]]
    loops: list[tuple[str, str]]
    lines: list[dict[str, Any]]
    told: str
    path: Path

    def points(self) -> dict[tuple[str, int], np.ndarray]:
        """Return where each map point is, by session and id; each is placed once."""
        found: dict[tuple[str, int], np.ndarray] = {}
        for body in self.keyframes.values():
            ids, positions = points_of(body)
            for id, position in zip(ids, positions):
                assert (body["session"], id) not in found, "placed twice"
                found[body["session"], id] = position
        return found


def imported(source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], *more: object, name: str = "o.ndjson.zst") -> Imported:
    """Import a file; it must succeed."""
    output = tmp_path / name
    status = main(["import", str(source), "--output", str(output), *map(str, more)])
    told = capsys.readouterr().err
    assert status == 0, told
    lines = read(output)
    keyframes = {line["id"]: line["body"] for line in lines if line["op"] == "keyframe"}
    loops = [(line["body"]["keyframe"], line["body"]["candidate"]) for line in lines if line["op"] == "loop"]
    assert lines[0]["op"] == "map"
    written: set[str] = set()
    for line in lines[1:]:
        # Nothing names what is not in the recording.
        named = [line["body"]["keyframe"], line["body"]["candidate"]] if line["op"] == "loop" else []
        named += [other["keyframe"] for other in line.get("body", {}).get("covisible", [])]
        assert written.issuperset(named), line
        written.add(line.get("id", ""))
    return Imported(lines[0]["body"], keyframes, loops, lines, told, output)


def refused(source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], *more: object) -> str:
    """Import a file that cannot be; return the one line that tells why."""
    output = tmp_path / "refused.ndjson.zst"
    status = main(["import", str(source), "--output", str(output), *map(str, more)])
    told = capsys.readouterr().err
    assert status == 1 and told.startswith("revisit-play: ") and told.count("\n") == 1, told
    assert not output.exists() and not output.with_name(output.name + ".part").exists()
    return told


def read(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a recording."""
    data = path.read_bytes()
    if path.suffix == ".zst":
        data = zstandard.ZstdDecompressor().stream_reader(data).read()
    return [json.loads(line) for line in data.splitlines()]


def column(body: dict[str, Any], name: str, packed: str, dtype: str, width: int = 1) -> np.ndarray:
    """Return a column that is packed or a list."""
    if packed in body:
        values = np.frombuffer(base64.b64decode(body[packed]), dtype)
    else:
        values = np.array(body.get(name, []), dtype)
    return values.reshape(-1, width) if width > 1 else values


def points_of(body: dict[str, Any]) -> tuple[list[int], np.ndarray]:
    """Return the map points that a keyframe places."""
    placed = body.get("map_points", {})
    return column(placed, "ids", "ids_i64", "<i8").tolist(), column(placed, "positions", "positions_f64", "<f8", 3)


def observes(body: dict[str, Any]) -> list[int]:
    """Return the map points that a keyframe observes without a feature."""
    return column(body, "observes", "observes_i64", "<i8").tolist()


def features_of(body: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return keypoints (u, v, octave, angle), map points and descriptors."""
    features = body["features"]
    descriptors = np.frombuffer(base64.b64decode(features["descriptors"]), np.uint8).reshape(-1, features["descriptor_bytes"])
    keypoints = column(features, "keypoints", "keypoints_f32", "<f4", 4)
    return keypoints, column(features, "map_points", "map_points_i64", "<i8"), descriptors


def pose_of(body: dict[str, Any]) -> np.ndarray:
    """Return `map_from_camera`."""
    pose = np.eye(4)
    pose[:3, :3] = rotation(np.array([body["pose"]["rotation"][axis] for axis in "xyzw"]))
    pose[:3, 3] = [body["pose"]["translation"][axis] for axis in "xyz"]
    return pose


def projected(body: dict[str, Any], positions: np.ndarray) -> np.ndarray:
    """Return where a keyframe's camera sees positions of its session."""
    pose, camera = pose_of(body), body["camera"]
    seen = (positions - pose[:3, 3]) @ pose[:3, :3]
    assert (seen[:, 2] > 0).all(), "behind the camera"
    return seen[:, :2] / seen[:, 2:] * (camera["fx"], camera["fy"]) + (camera["cx"], camera["cy"])


def shared() -> Path:
    """Return the folder of real samples, or skip the test."""
    named = os.environ.get("REVISIT_SHARED")
    if not named:
        pytest.skip("needs REVISIT_SHARED")
    return Path(named)
