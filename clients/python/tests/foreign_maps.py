"""Synthetic maps of other systems: the drive of `foreign_world` in each one's own schema, written by these tests."""

from __future__ import annotations

import sqlite3
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from foreign_world import BASE_FROM_CAMERA, CX, CY, FX, FY, HEIGHT, WIDTH, Stand, World

RTABMAP_SCHEMA = """
create table Node (id integer not null, map_id integer not null, weight integer, stamp float, pose blob, ground_truth_pose blob,
  velocity blob, label text, gps blob, env_sensors blob, time_enter date, primary key (id));
create table Data (id integer not null, image blob, depth blob, depth_confidence blob, calibration blob, scan blob, scan_info blob,
  ground_cells blob, obstacle_cells blob, empty_cells blob, cell_size float, view_point_x float, view_point_y float,
  view_point_z float, user_data blob, time_enter date, primary key (id));
create table Link (from_id integer not null, to_id integer not null, type integer not null, information_matrix blob not null,
  transform blob, user_data blob, foreign key (from_id) references Node(id), foreign key (to_id) references Node(id));
create table Word (id integer not null, descriptor_size integer not null, descriptor blob not null, time_enter date, primary key (id));
create table Feature (node_id integer not null, word_id integer not null, pos_x float not null, pos_y float not null,
  size integer not null, dir float not null, response float not null, octave integer not null, depth_x float, depth_y float,
  depth_z float, descriptor_size integer, descriptor blob, foreign key (node_id) references Node(id));
create table Admin (version text, preview_image blob, opt_cloud blob, opt_ids blob, opt_poses blob, opt_last_localization blob,
  time_enter date);
create index IDX_Feature_node_id on Feature (node_id);
create index IDX_Link_from_id on Link (from_id);
"""
NEIGHBOUR, LOOP = 0, 1
# A tag that the first node saw, ahead of it.
TAG = 12
TAG_IN_MAP = np.array([[0, -1, 0, 4.0], [1, 0, 0, 1.0], [0, 0, 1, 0.5], [0, 0, 0, 1]])
TAG_SIDE_M = 0.25
# Nodes count from 1; every third feature has no depth.
WITHOUT_DEPTH = 3
# What odometry makes of the drive: optimised poses put it right.
DRIFT = np.array([[1, 0, 0, 0.5], [0, 1, 0, -0.25], [0, 0, 1, 0], [0, 0, 0, 1]])


def compressed(matrix: np.ndarray) -> bytes:
    """Return a matrix as RTAB-Map compresses it."""
    kind = {"uint8": 0, "int32": 4, "float32": 5}[matrix.dtype.name]
    rows, columns = matrix.shape
    return zlib.compress(np.ascontiguousarray(matrix).tobytes()) + struct.pack("<iii", rows, columns, kind)


def floats(pose: np.ndarray) -> bytes:
    """Return a pose as 3 x 4 floats."""
    return pose[:3].astype("<f4").tobytes()


def mono_calibration(fx: float = FX, width: int = WIDTH) -> bytes:
    """Return a camera as RTAB-Map 0.18 and later keeps it: K, and the projection P, which counts."""
    k = [2 * fx, 0, CX, 0, 2 * FY, CY, 0, 0, 1]
    p = [fx, 0, CX, 0, 0, FY, CY, 0, 0, 0, 1, 0]
    header = struct.pack("<11i", 0, 21, 4, 0, width, HEIGHT, 9, 5, 0, 12, 12)
    return header + np.array([*k, *[0.0] * 5, *p], "<f8").tobytes() + floats(BASE_FROM_CAMERA)


def stereo_calibration() -> bytes:
    """Return two cameras."""
    left, right = mono_calibration(), mono_calibration(1.0)
    return struct.pack("<10i", 0, 21, 4, 1, 9, 3, 0, 0, len(left), len(right)) + bytes(8 * 12) + left + right


def floats_calibration() -> bytes:
    """Return a camera as RTAB-Map before 0.18 keeps it."""
    return np.array([FX, FY, CX, CY, WIDTH, HEIGHT], "<f4").tobytes() + floats(BASE_FROM_CAMERA)


def in_base(world: World, stand: Stand) -> np.ndarray:
    """Return the points of a stand in the frame of its base."""
    return (world.points[stand.seen] - stand.map_from_base[:3, 3]) @ stand.map_from_base[:3, :3]


def rtabmap(
    path: Path, world: World, *, calibration: bytes | None = None, version: str = "0.21.4", optimised: bool = True, binary: bool = True,
    earlier: int = 0, side_m: float | None = TAG_SIDE_M,
) -> Path:
    """Write an RTAB-Map database; node 100 lies between keyframes, node 101 is not in the optimised graph.

    So many `earlier` stands are a session of their own, which nothing joins with the optimised graph.
    """
    database = sqlite3.connect(path)
    database.executescript(RTABMAP_SCHEMA)
    ids, poses = [], []
    for stand in world.stands:
        id = stand.number + 1
        database.execute(
            "insert into Node (id, map_id, weight, stamp, pose) values (?, ?, 1, ?, ?)",
            (id, int(0 < earlier < id), stand.stamp_s, floats(DRIFT @ stand.map_from_base)),
        )
        database.execute("insert into Data (id, calibration) values (?, ?)", (id, calibration or mono_calibration()))
        if id > earlier:
            ids.append(id)
            poses.append(stand.map_from_base[:3].astype(np.float32).ravel())
        for at, (point, pixel, place) in enumerate(zip(stand.seen, stand.pixels, in_base(world, stand))):
            depth = [None] * 3 if at % WITHOUT_DEPTH == 0 else [float(np.float32(value)) for value in place]
            descriptor = world.descriptors[point].tobytes() if binary else np.zeros(64, "<f4").tobytes()
            u, v = (float(np.float32(value)) for value in pixel)
            database.execute(
                "insert into Feature values (?, ?, ?, ?, 31, ?, 0.5, ?, ?, ?, ?, ?, ?)",
                (id, int(point) + 1, u, v, float(world.angles_deg[point]), int(point) % 8, *depth, 32 if binary else 64, descriptor),
            )
        if id not in (1, earlier + 1):
            _link(database, id, id - 1, NEIGHBOUR)
    _link(database, len(world.stands), earlier + 1, LOOP)
    # Unlike other links one from the node to the tag only, with the tag's side.
    place = np.linalg.inv(world.stands[0].map_from_base) @ TAG_IN_MAP if world.stands else np.eye(4)
    side = None if side_m is None else compressed(np.array([[side_m]], np.float32))
    database.execute("insert into Link values (1, ?, 8, ?, ?, ?)", (-TAG, bytes(288), floats(place), side))
    for id, weight in ((100, -1), (101, 0)):
        database.execute(
            "insert into Node (id, map_id, weight, stamp, pose) values (?, 0, ?, 1, ?)", (id, weight, None if optimised else b"")
        )
    packed = (compressed(np.array([ids], np.int32)), compressed(np.array([np.concatenate(poses)]))) if optimised else (None, None)
    database.execute("insert into Admin (version, opt_ids, opt_poses) values (?, ?, ?)", (version, *packed))
    database.commit()
    database.close()
    return path


def _link(database: sqlite3.Connection, one: int, other: int, kind: int) -> None:
    for ends in ((one, other), (other, one)):
        database.execute("insert into Link values (?, ?, ?, ?, ?, null)", (*ends, kind, bytes(288), floats(np.eye(4))))


STELLA_SCHEMA = """
create table cameras (id integer primary key, name blob, setup_type blob, model_type blob, color_type blob, cols integer, rows integer,
  fps real, fx real, fy real, cx real, cy real, k1 real, k2 real, p1 real, p2 real, k3 real, k4 real, focal_x_baseline real,
  distortion real);
create table keyframes (id integer primary key, src_frm_id integer, ts real, cam blob, orb_params blob, pose_cw blob, n_keypts integer,
  undist_keypts blob, x_rights blob, depths blob, descs blob, n_markers integer, markers blob);
create table landmarks (id integer primary key, first_keyfrm integer, pos_w blob, ref_keyfrm integer, n_vis integer, n_fnd integer);
create table associations (id integer primary key, lm_ids blob, span_parent integer, n_spanning_children integer, spanning_children blob,
  n_loop_edges integer, loop_edges blob);
create table stats (id integer primary key, frame_next_id integer, keyframe_next_id integer, landmark_next_id integer);
"""
KEYPOINT = [("x", "<f4"), ("y", "<f4"), ("size", "<f4"), ("angle", "<f4"), ("response", "<f4"), ("octave", "<i4"), ("class", "<i4")]
# Numbers as texts are in another order: keyframe 10 comes before keyframe 2.
STELLA_STEP = 5


def stella_keyframes(world: World) -> list[dict[str, Any]]:
    """Return the keyframes of a stella_vslam map; every fourth keypoint has no landmark, one loop edge joins the ends."""
    found = []
    for stand in world.stands:
        landmarks = [-1 if at % 4 == 0 else int(point) for at, point in enumerate(stand.seen)]
        ends = {0: [STELLA_STEP * (len(world.stands) - 1)], len(world.stands) - 1: [0]}
        found.append({"id": STELLA_STEP * stand.number, "stand": stand, "landmarks": landmarks, "loops": ends.get(stand.number, [])})
    return found


def camera_from_map(stand: Stand) -> np.ndarray:
    """Return the inverse of a stand's camera pose."""
    return np.linalg.inv(stand.map_from_camera)


def stella(path: Path, world: World, *, setup: str = "Stereo", model: str = "Perspective") -> Path:
    """Write a stella_vslam map as SQLite."""
    database = sqlite3.connect(path)
    database.executescript(STELLA_SCHEMA)
    sizes = (WIDTH, HEIGHT, 30.0, FX, FY, CX, CY) if model != "Equirectangular" else (WIDTH, HEIGHT, 30.0, *[None] * 4)
    columns = "id, name, setup_type, model_type, color_type, cols, rows, fps, fx, fy, cx, cy"
    database.execute(
        f"insert into cameras ({columns}) values (0, {', '.join('?' * 11)})",
        (b"front", setup.encode(), model.encode(), b"RGB", *sizes),
    )
    for keyframe in stella_keyframes(world):
        stand, id = keyframe["stand"], keyframe["id"]
        points = np.zeros(len(stand.seen), KEYPOINT)
        points["x"], points["y"], points["class"] = *stand.pixels.T, -1
        points["angle"], points["octave"] = world.angles_deg[stand.seen], stand.seen % 8
        database.execute(
            "insert into keyframes values (?, null, ?, ?, ?, ?, ?, ?, null, null, ?, 0, null)",
            (
                id, stand.stamp_s, b"front", b"default", camera_from_map(stand).T.astype("<f8").tobytes(), len(stand.seen),
                points.tobytes(), world.descriptors[stand.seen].tobytes(),
            ),
        )  # fmt: skip
        loops = np.array(keyframe["loops"], "<i4").tobytes()
        database.execute(
            "insert into associations values (?, ?, -1, 0, null, ?, ?)",
            (id, np.array(keyframe["landmarks"], "<i4").tobytes(), len(keyframe["loops"]), loops),
        )
    for id, place in enumerate(world.points):
        database.execute("insert into landmarks values (?, 0, ?, 0, 3, 3)", (id, place.astype("<f8").tobytes()))
    database.execute("insert into stats values (0, 0, 100, 1000)")
    database.commit()
    database.close()
    return path


def stella_packed(path: Path, world: World, *, setup: str = "Stereo") -> Path:
    """Write the same map as MessagePack, its keys in the order of texts."""
    import msgpack

    from revisit_slam.pixels.rotations import quaternion_xyzw

    keyframes = {}
    for keyframe in stella_keyframes(world):
        stand = keyframe["stand"]
        pose = camera_from_map(stand)
        keyframes[str(keyframe["id"])] = {
            "cam": "front", "depths": [], "orb_params": "default", "span_children": [], "span_parent": -1, "x_rights": [],
            "descs": [[int(word) for word in world.descriptors[point].view("<u4")] for point in stand.seen],
            "lm_ids": keyframe["landmarks"], "loop_edges": keyframe["loops"], "n_keypts": len(stand.seen),
            "rot_cw": quaternion_xyzw(pose[:3, :3]).tolist(), "trans_cw": pose[:3, 3].tolist(), "ts": stand.stamp_s,
            "undist_keypts": [
                {"ang": float(world.angles_deg[point]), "oct": int(point) % 8, "pt": np.float32(pixel).tolist()}
                for point, pixel in zip(stand.seen, stand.pixels)
            ],
        }  # fmt: skip
    camera = {"model_type": "Perspective", "setup_type": setup, "color_order": "RGB", "cols": WIDTH, "rows": HEIGHT, "fps": 30.0}
    landmarks = {
        str(id): {"1st_keyfrm": 0, "n_fnd": 3, "n_vis": 3, "pos_w": place.tolist(), "ref_keyfrm": 0}
        for id, place in enumerate(world.points)
    }
    path.write_bytes(
        msgpack.packb(
            {
                "cameras": {"front": {**camera, "fx": FX, "fy": FY, "cx": CX, "cy": CY}},
                "keyframe_next_id": 100,
                "keyframes": dict(sorted(keyframes.items())),
                "landmark_next_id": 1000,
                "landmarks": dict(sorted(landmarks.items())),
                "orb_params": {},
            }
        )
    )
    return path
