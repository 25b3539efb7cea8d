"""Files of other people: their text, their rows, and what a file is that is not what it should be."""

from __future__ import annotations

import codecs
import csv
from collections.abc import Iterable
from pathlib import Path

from .errors import RevisitError

# How a text may begin: marks of the encodings that Windows writes. The longer marks come first.
MARKS = (
    (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip
MCAP = b"\x89MCAP0\r\n"
# How files begin, what they are, and what to do with them.
BEGINNINGS = (
    (b"version https://git-lfs", "a pointer of Git LFS: `git lfs pull` fetches the file itself"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd: unpack it (`zstd -d`)"),
    (b"\x1f\x8b", "compressed with gzip: unpack it (`gunzip`)"),
    (b"BZh", "compressed with bzip2: unpack it (`bunzip2`)"),
    (b"PK\x03\x04", "a zip archive: unpack it"),
    (b"\xfd7zXZ", "compressed with xz: unpack it (`unxz`)"),
    (MCAP, "a ROS 2 recording (MCAP)"),
    (b"#ROSBAG", "a ROS 1 bag"),
    (b"SQLite format 3\0", "an SQLite database"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"%PDF", "a PDF document"),
    (b"<!DOCTYPE html", "a web page"),
    (b"<html", "a web page"),
    (b"<?xml", "an XML document"),
)
# What saves what is in a recording or a database that was not closed, or is damaged.
MENDED = {
    "a ROS 2 recording (MCAP)": "`mcap recover {0} -o OUT.mcap` saves what is in it",
    "a ROS 1 bag": "`rosbag reindex {0}` saves what is in it",
    "an SQLite database": "`sqlite3 {0} .recover | sqlite3 OUT.db` saves what is in it",
}
FIRST_BYTES = 64
# What is written in letters, and is never the text that was meant.
NO_TEXTS = (b"version https://git-lfs", b"<!doctype html", b"<html")
# The signs between a table's columns: a comma, Excel's semicolon, a tabulator.
SEPARATORS = ",;\t"


def what_is(first: bytes) -> str:
    """Return what a file looks like by its first bytes, with the next step; nothing where that is not known."""
    if not first:
        return "empty"
    if first[4:8] == b"ftyp" and first[8:11] in (b"hei", b"hev", b"mif", b"msf", b"avi"):
        return "a HEIC or AVIF picture"
    return next((told for begins, told in BEGINNINGS if first.lower().startswith(begins.lower())), "")


def first_bytes(path: Path) -> bytes:
    """Return how a file begins."""
    try:
        with path.open("rb") as file:
            return file.read(FIRST_BYTES)
    except OSError as error:
        raise RevisitError(f"{path}: cannot be read: {error.strerror}") from error


def how_to_mend(path: Path) -> str:
    """Return the next step with a file that its reader cannot open, or else what it looks like; nothing if unknown."""
    if path.is_dir():
        return f"`ros2 bag reindex {path}` writes the metadata.yaml of a bag's folder"
    form = what_is(first_bytes(path))
    return MENDED.get(form, f"it looks like this: {form}" if form else "").format(path)


def text_of(path: Path, form: str = "a text") -> str:
    """Return a file's text, in UTF-8 or with the mark of another encoding; `form` says what it should be.

    Raises:
        RevisitError: It cannot be read, or is no text; the error says what it looks like.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RevisitError(f"{path}: cannot be read: {error.strerror}; it should be {form}") from error
    encoding = next((encoding for mark, encoding in MARKS if data.startswith(mark)), "utf-8")
    try:
        text = data.decode("utf-8-sig" if encoding == "utf-8" else encoding)
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text or data[:FIRST_BYTES].lower().startswith(NO_TEXTS):
        told = what_is(data[:FIRST_BYTES]) or "neither UTF-8 nor UTF-16 with its mark: save it as UTF-8"
        raise RevisitError(f"{path}: not {form}, but {told}")
    return text


def not_a(form: str, path: Path) -> RevisitError:
    """Return the error for a file that can be read, and is not what it should be."""
    told = what_is(first_bytes(path))
    return RevisitError(f"{path}: not {form}" + (f", but {told}" if told else ""))


def numbered_rows_of(path: Path, form: str = "a table (CSV)") -> list[tuple[int, list[str]]]:
    """Return the rows of a table without blanks around its cells, each with its line; comments and empty rows are left out."""
    lines = [one for one in enumerate(text_of(path, form).splitlines(), 1) if one[1].strip(" \t,;")]
    # Excel's own first line is a comment as well.
    lines = [(number, line) for number, line in lines if not line.lstrip().lower().startswith(("#", "sep="))]
    separator = max(SEPARATORS, key=lines[0][1].count) if lines else ","
    reader = csv.reader((line for _, line in lines), delimiter=separator)
    try:
        return [(lines[reader.line_num - 1][0], [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise RevisitError(f"{path}: not {form}: {error} (a quotation mark that is not closed?)") from error


def records_of(path: Path, columns: Iterable[str]) -> list[tuple[int, dict[str, str]]]:
    """Return each row of a table with its line, its cells by the first row's names in small letters; `columns` are there."""
    (_, head), *rows = numbered_rows_of(path) or [(0, [])]
    names = [name.lower() for name in head]
    if not set(columns) <= set(names):
        needed = "` and `".join(columns)
        raise RevisitError(f"{path}: no columns `{needed}` in its first line, which is: {', '.join(head)[:200]}")
    return [(line, {**dict.fromkeys(names, ""), **dict(zip(names, row))}) for line, row in rows]
