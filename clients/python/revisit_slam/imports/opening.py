"""Opening: which system wrote a file, by its first bytes and its tables."""

from __future__ import annotations

from pathlib import Path

from ..errors import RevisitError
from ..files import MCAP, first_bytes, how_to_mend, what_is
from .opened import Opened, Wanted
from .sqlite_file import MAGIC as SQLITE
from .sqlite_file import tables

# A table that only one system's databases have; the last is that of a ROS 2 bag.
TABLES = {"colmap": "two_view_geometries", "rtabmap": "Node", "stella": "keyframes", "mcap": "topics"}
MODEL_FILES = ("cameras", "images", "points3D")
KNOWN = "a COLMAP model's folder or database, an RTAB-Map or stella_vslam map, or a ROS 2 recording (MCAP) with rtabmap_msgs/MapData"


def open_file(path: Path, form: str, wanted: Wanted) -> Opened:
    """Open a file as what it is, or as what a person says it is."""
    form = _form(path) if form == "auto" else form
    if wanted.database is not None and form != "colmap":
        raise RevisitError("--database: it belongs to a COLMAP model")
    if form == "colmap" and path.is_dir():
        from .colmap.model import open_model

        return open_model(path, wanted)
    if form == "colmap":
        from .colmap.database import open_database

        return open_database(path, wanted)
    if form == "rtabmap":
        from .rtabmap.database import open_database as open_rtabmap

        return open_rtabmap(path, wanted)
    if form == "mcap":
        from .rtabmap.map_data import open_map_data

        return open_map_data(path, wanted)
    if form == "stella":
        from .stella.database import open_database as open_stella
        from .stella.packed import open_packed

        return open_stella(path, wanted) if _is_sqlite(path) else open_packed(path, wanted)
    raise RevisitError(f"{path}: not {KNOWN}{_told_instead(path)}")


def _is_sqlite(path: Path) -> bool:
    return first_bytes(path).startswith(SQLITE)


def _form(path: Path) -> str:
    if path.is_dir():
        return "mcap" if any(next(path.glob(name), None) for name in ("metadata.yaml", "*.mcap", "*.db3")) else "colmap"
    first = first_bytes(path)
    if first.startswith(MCAP):
        return "mcap"
    if first.startswith(SQLITE):
        found = tables(path)
        for form, table in TABLES.items():
            if table in found:
                return form
        lacks = "no tables (where it was copied, its `-wal` is a part of it)"
        raise RevisitError(f"{path}: a database of none of the systems: it has {', '.join(sorted(found)[:12]) or lacks}")
    return "stella" if _is_map_of_msgpack(first) else "unknown"


def _told_instead(path: Path) -> str:
    """Return what a file looks like that is none of the known ones, and the next step."""
    first = first_bytes(path)
    if path.name.split(".")[0] in MODEL_FILES:
        return f"; of a COLMAP model its folder is imported: {path.absolute().parent}"
    if first.startswith(b"#ROSBAG"):
        return f", but a ROS 1 bag ({how_to_mend(path)}): import RTAB-Map's own database; `revisit-play bag` plays its pictures"
    looks = what_is(first) or ("a text" if first.isascii() and b"\0" not in first else "")
    return f", but it looks like this: {looks}" if looks else ""


def _is_map_of_msgpack(first: bytes) -> bool:
    """Whether the first byte begins a map of MessagePack, as stella_vslam's does."""
    return bool(first) and (0x80 <= first[0] <= 0x8F or first[0] in (0xDE, 0xDF))
