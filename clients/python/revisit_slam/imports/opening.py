"""Opening: which system wrote a file, by its first bytes and its tables."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from ..errors import RevisitError
from ..files import MCAP, first_bytes, how_to_mend, what_is
from .opened import Opened, Wanted
from .sqlite_file import MAGIC as SQLITE
from .sqlite_file import tables

# A table that only one system's databases have; the last is that of a ROS 2 bag.
TABLES = {"colmap": "two_view_geometries", "rtabmap": "Node", "stella": "keyframes", "mcap": "topics"}
READERS = {
    "model": ".colmap.model", "colmap": ".colmap.database", "rtabmap": ".rtabmap.database", "mcap": ".rtabmap.map_data",
    "stella": ".stella.database", "packed": ".stella.packed",
}  # fmt: skip
MODEL_FILES = ("cameras", "images", "points3D")
KNOWN = "a COLMAP model's folder or database, an RTAB-Map or stella_vslam map, or a ROS 2 recording (MCAP) with rtabmap_msgs/MapData"


def open_file(path: Path, form: str, wanted: Wanted) -> Opened:
    """Open a file as what it is, or as what a person says it is."""
    form = _form(path) if form == "auto" else form
    if wanted.database is not None and form != "colmap":
        raise RevisitError("--database: it belongs to a COLMAP model")
    if form == "unknown":
        raise RevisitError(f"{path}: not {KNOWN}{_told_instead(path)}")
    if form == "colmap" and path.is_dir():
        form = "model"
    if form == "stella" and not first_bytes(path).startswith(SQLITE):
        form = "packed"
    # Only what reads this file need be installed.
    return import_module(READERS[form], __package__).open_map(path, wanted)


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
        own = "import RTAB-Map's own database, or play its pictures: `revisit-play bag`"
        return f", but a ROS 1 bag: {own} (where it was not closed, {how_to_mend(path)})"
    looks = what_is(first) or ("a text" if first.isascii() and b"\0" not in first else "")
    return f", but it looks like this: {looks}" if looks else ""


def _is_map_of_msgpack(first: bytes) -> bool:
    """Whether the first byte begins a map of MessagePack, as stella_vslam's does."""
    return bool(first) and (0x80 <= first[0] <= 0x8F or first[0] in (0xDE, 0xDF))
