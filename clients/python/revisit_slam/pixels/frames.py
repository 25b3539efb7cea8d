"""Photographs of a folder, in order, with the video that each belongs to."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from ..errors import RevisitError

SUFFIXES = {".jpg", ".jpeg", ".png", ".bmp", ".webp", ".tif", ".tiff"}
MAX_ID = 128


@dataclass(frozen=True)
class Frame:
    """One photograph: its id (the file's stem), its video (the stem before the number, and the folder), its number."""

    id: str
    path: Path
    video: str
    number: int


def list_frames(folder: Path) -> list[Frame]:
    """Return the photographs below `folder`, by folder, video and number."""
    if not folder.is_dir():
        raise RevisitError(f"{folder}: no such folder")
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())
    if not paths:
        raise RevisitError(f"{folder}: no photographs in it ({', '.join(sorted(SUFFIXES))})")
    # Two folders may both have a 0001.jpg: then the folder's name goes before it.
    twice = {stem for stem, count in Counter(path.stem for path in paths).items() if count > 1}
    frames, taken = [], {}
    for path in paths:
        inside = path.relative_to(folder)
        name = ".".join((*inside.parts[:-1], path.stem)) if path.stem in twice else path.stem
        id = re.sub(r"[^A-Za-z0-9._:-]", "_", name)
        if len(id) > MAX_ID:
            raise RevisitError(f"{path}: its name has more than {MAX_ID} characters")
        if id in taken:
            raise RevisitError(f"{path} and {taken[id]} both become keyframe {id}: rename one")
        taken[id] = path
        video, number = split_number(path.stem)
        frames.append(Frame(id, path, "/".join((*inside.parts[:-1], video)), number))
    return sorted(frames, key=lambda frame: (frame.path.parent, frame.video, frame.number, frame.id))


def split_number(stem: str) -> tuple[str, int]:
    """Return the stem without the number at its end, and the number (0 where there is none)."""
    found = re.search(r"^(.*?)[-_. ]*(?:frame|img|image)?[-_. ]*(\d+)$", stem, re.IGNORECASE)
    if found is None:
        return stem, 0
    return found.group(1), int(found.group(2))
