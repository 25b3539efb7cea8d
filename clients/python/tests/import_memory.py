#!/usr/bin/env python3
"""Memory of `revisit-play import`: makes a large synthetic file of each form, imports it, and prints the peak.

    tests/import_memory.py [--megabytes 1024] [--folder DIR] [FORM...]

It needs room for a file and its recording, and takes minutes; no test runs it. Forms are colmap_bin, colmap_txt, rtabmap,
stella, stella_packed and map_data.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import foreign_maps
import foreign_messages
from foreign_world import CX, CY, FX, FY, HEIGHT, WIDTH, Stand, World

LIMIT_MB = 500
FEATURES = 2000
POINTS = 500_000


def stand(number: int, features: int = FEATURES) -> Stand:
    """Return a stand that sees some of many points, somewhere in the picture."""
    seen = (np.arange(features) + number * features // 10) % POINTS
    pixels = np.column_stack((np.arange(features) % WIDTH, np.arange(features) % HEIGHT)).astype(float)
    pose = np.eye(4)
    pose[:3, 3] = number * 0.1, 0, 0
    return Stand(number, 1.7e9 + number, pose, seen, pixels)


def many_points() -> World:
    """Return points without a drive."""
    random = np.random.default_rng(1)
    angles = random.uniform(0, 360, POINTS).astype(np.float32)
    return World(random.uniform(-50, 50, (POINTS, 3)), random.integers(0, 256, (POINTS, 32), np.uint8), angles, [])


def colmap_bin(folder: Path, size: int) -> Path:
    """Write a binary model: half of it features, half of it points."""
    features, points = 10_000, size // 2 // 99
    images = size // 2 // (features * 24)
    (folder / "cameras.bin").write_bytes(struct.pack("<Qii2Q4d", 1, 1, 1, WIDTH, HEIGHT, FX, FY, CX, CY))
    with (folder / "images.bin").open("wb") as file:
        file.write(struct.pack("<Q", images))
        seen = np.zeros(features, [("x", "<f8"), ("y", "<f8"), ("point", "<i8")])
        for number in range(images):
            seen["point"] = (np.arange(features) + number * features // 3) % points + 1
            file.write(struct.pack("<I7dI", number + 1, 1, 0, 0, 0, number, 0, 0, 1) + f"{number:06}.jpg\0".encode())
            file.write(struct.pack("<Q", features) + seen.tobytes())
    with (folder / "points3D.bin").open("wb") as file:
        file.write(struct.pack("<Q", points))
        # In no order, as COLMAP writes them.
        for id in np.random.default_rng(1).permutation(points) + 1:
            file.write(struct.pack("<Q3d3BdQ", int(id), id * 1e-3, 1, 2, 9, 9, 9, 0.5, 7) + bytes(56))
    return folder


def colmap_txt(folder: Path, size: int) -> Path:
    """Write the same as text."""
    features, points = 10_000, size // 2 // 60
    (folder / "cameras.txt").write_text(f"1 PINHOLE {WIDTH} {HEIGHT} {FX} {FY} {CX} {CY}\n")
    with (folder / "images.txt").open("w") as file:
        number = 0
        while file.tell() < size // 2:
            file.write(f"{number + 1} 1 0 0 0 {number} 0 0 1 {number:06}.jpg\n")
            ids = (np.arange(features) + number * features // 3) % points + 1
            file.write(" ".join(f"123.4567 234.5678 {id}" for id in ids) + "\n")
            number += 1
    with (folder / "points3D.txt").open("w") as file:
        file.writelines(f"{id} {id * 1e-3:.6f} 1.0 2.0 9 9 9 0.5 1 2 3 4 5 6 7 8 9 10 11 12\n" for id in range(1, points + 1))
    return folder


def rtabmap(folder: Path, size: int) -> Path:
    """Write an RTAB-Map database: nodes of 1,000 features and a picture."""
    nowhere = World(np.zeros((1, 3)), np.zeros((1, 32), np.uint8), np.zeros(1, np.float32), [])
    path = foreign_maps.rtabmap(folder / "large.db", nowhere, optimised=False)
    features, picture = 1000, os.urandom(100_000)
    descriptors = [os.urandom(32) for _ in range(features)]
    with sqlite3.connect(path, isolation_level=None) as database:
        database.execute("pragma synchronous=off")
        database.execute("begin")
        database.execute("delete from Node")
        for id in range(1, size // (len(picture) + features * 120) + 1):
            pose = np.eye(4)
            pose[0, 3] = id
            posed = (id, 1e9 + id, foreign_maps.floats(pose))
            database.execute("insert into Node (id, map_id, weight, stamp, pose) values (?, 0, 1, ?, ?)", posed)
            database.execute("insert into Data (id, image, calibration) values (?, ?, ?)", (id, picture, foreign_maps.mono_calibration()))
            database.executemany(
                "insert into Feature values (?, ?, 320.5, 240.5, 31, 45.5, 0.5, 3, 1.25, 2.5, 3.75, 32, ?)",
                ((id, id * 300 + at, descriptor) for at, descriptor in enumerate(descriptors)),
            )
            if id > 1:
                foreign_maps._link(database, id, id - 1, foreign_maps.NEIGHBOUR)
        database.execute("commit")
    return path


def stella(folder: Path, size: int) -> Path:
    """Write a stella_vslam map as SQLite."""
    drive = many_points()
    count = size // (FEATURES * 66)
    drive.stands.append(stand(0))
    path = foreign_maps.stella(folder / "large.db", drive)
    with sqlite3.connect(path, isolation_level=None) as database:
        database.execute("pragma synchronous=off")
        database.execute("begin")
        for number in range(1, count):
            database.execute(
                "insert into keyframes select ?, null, ? + ts, cam, orb_params, pose_cw, n_keypts, undist_keypts, null, null, descs, 0, "
                "null from keyframes where id = 0",
                (number, number),
            )
            ids = stand(number).seen.astype("<i4").tobytes()
            database.execute("insert into associations values (?, ?, -1, 0, null, 0, null)", (number, ids))
        database.execute("commit")
    return path


def stella_packed(folder: Path, size: int) -> Path:
    """Write the same as MessagePack; the keypoints of every keyframe are alike."""
    import msgpack

    drive = many_points()
    drive.stands.append(stand(0))
    small = foreign_maps.stella_packed(folder / "small.msg", drive)
    whole = msgpack.unpackb(small.read_bytes())
    keyframe = whole["keyframes"]["0"]
    packer = msgpack.Packer()
    fixed = b"".join(packer.pack(name) + packer.pack(value) for name, value in keyframe.items() if name != "lm_ids")
    one = len(fixed) + 5 * FEATURES
    landmarks = msgpack.packb(whole["landmarks"])
    count = max((size - len(landmarks)) // one, 1)
    path = folder / "large.msg"
    with path.open("wb") as file:
        file.write(packer.pack_map_header(4) + packer.pack("cameras") + packer.pack(whole["cameras"]) + packer.pack("keyframes"))
        file.write(packer.pack_map_header(count))
        for number in range(count):
            file.write(packer.pack(str(number)) + packer.pack_map_header(len(keyframe)) + fixed)
            file.write(packer.pack("lm_ids") + packer.pack(stand(number).seen.tolist()))
        file.write(packer.pack("landmarks") + landmarks + packer.pack("orb_params") + packer.pack({}))
    small.unlink()
    return path


def map_data(folder: Path, size: int) -> Path:
    """Write a recording of MapData: nodes of 1,000 words and a picture of a megabyte."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    drive, messages = many_points(), foreign_messages.Messages()
    picture = np.frombuffer(os.urandom(1 << 20), np.uint8)
    stands = [stand(number, 1000) for number in range(size // (len(picture) + 150_000))]
    with Writer(folder / "large", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/rtabmap/mapData", foreign_messages.MAP_DATA, typestore=messages.store)
        for count in range(1, len(stands) + 1):
            links = [(number + 1, number, foreign_maps.NEIGHBOUR) for number in range(1, count)]
            node = messages.node(drive, stands[count - 1])
            node.data.left_compressed = picture
            message = messages.make(
                foreign_messages.MAP_DATA, header=messages.header(float(count)), graph=messages.graph(stands[:count], links), nodes=[node]
            )
            writer.write(connection, count, messages.store.serialize_cdr(message, foreign_messages.MAP_DATA))
    return next((folder / "large").glob("*.mcap"))


FORMS: dict[str, Callable[[Path, int], Path]] = {
    made.__name__: made for made in (colmap_bin, colmap_txt, rtabmap, stella, stella_packed, map_data)
}


def main() -> int:
    """Make, import, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("forms", nargs="*", choices=[[], *FORMS], metavar="FORM")
    parser.add_argument("--megabytes", type=int, default=1024)
    parser.add_argument("--folder", type=Path, default=None, help="where the files go [the system's temporary folder]")
    chosen = parser.parse_args()
    worst = 0.0
    for form in chosen.forms or FORMS:
        folder = Path(tempfile.mkdtemp(prefix="revisit-memory-", dir=chosen.folder))
        try:
            path = FORMS[form](folder, chosen.megabytes << 20)
            bytes_in = sum(part.stat().st_size for part in (path.iterdir() if path.is_dir() else [path]))
            worst = max(worst, measured(form, path, folder / "o.ndjson.zst", bytes_in))
        finally:
            shutil.rmtree(folder)
    print(f"the most: {worst:.0f} MB; the aim: {LIMIT_MB} MB")
    return 0 if worst < LIMIT_MB else 1


def measured(form: str, path: Path, output: Path, bytes_in: int) -> float:
    """Import a file in a process of its own; print and return its peak in MB."""
    command = [sys.executable, "-m", "revisit_slam.play", "import", str(path), "-o", str(output)]
    script = f"import resource, subprocess, sys; done = subprocess.run({command!r}, stdout=subprocess.PIPE, text=True)\n"
    script += "print(done.stdout.splitlines()[0] if done.returncode == 0 else 'failed')\n"
    script += "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    began = time.monotonic()
    # In between, so that only the import is among its children.
    told, kib = subprocess.run([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    peak_mb = int(kib) * 1024 / 1e6
    print(f"{form}: {bytes_in / 1e6:.0f} MB read in {time.monotonic() - began:.0f} s, peak {peak_mb:.0f} MB; {told}", flush=True)
    if told == "failed":
        raise SystemExit(1)
    return peak_mb


if __name__ == "__main__":
    sys.exit(main())
