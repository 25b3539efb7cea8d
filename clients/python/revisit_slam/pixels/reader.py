"""Text reader: finds and reads texts in a photograph with rapidocr, twice."""

from __future__ import annotations

import hashlib
import json
import os
import threading
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path

import numpy as np

# Raised whenever the steps below change, so that old cached readings are not taken for new ones.
STEPS = 1
# Readings below this are not kept: they are mostly edges of furniture.
MIN_CONFIDENCE = 0.3
# Crops are enlarged to this height before the second reading; the recogniser works on 48 rows.
SECOND_HEIGHT_PX = 96
# Share of the line's height added around it in the second crop.
SECOND_MARGIN = 0.25
MAX_LINES = 64


@dataclass(frozen=True)
class Line:
    """One line of text: its box in pixels and two independent readings of it."""

    box: tuple[float, float, float, float]
    text: str
    confidence: float
    second_text: str
    second_confidence: float


class Reader:
    """A text reader for any threads, with an optional cache, keyed by what decides a reading: the photograph's view and the reader's version."""

    def __init__(self, cache: Path | None = None) -> None:
        self._cache = cache
        # Each thread has an engine of its own, so that readings do not depend on their number.
        self._own = threading.local()
        if cache is not None:
            cache.mkdir(parents=True, exist_ok=True)

    @property
    def version(self) -> str:
        """Name and version of the reader; readings of another one are not mixed with these."""
        return f"rapidocr-{metadata.version('rapidocr')}-{STEPS}"

    def read(self, data: bytes, image: np.ndarray) -> list[Line]:
        """Return the lines of text in `image` (BGR), as a person sees it; `data` are the bytes of its file, and what was done to them."""
        kept = self._kept(data)
        if kept is not None and kept.exists():
            try:
                return [Line(**{**line, "box": tuple(line["box"])}) for line in json.loads(kept.read_text())]
            except (ValueError, TypeError, KeyError):
                pass  # A file cut short by a crash: read again.
        lines = self._look(image)
        if kept is not None:
            # A rename, so that a run that is stopped leaves no half a file; two threads may read two equal pictures.
            part = kept.with_suffix(f".{os.getpid()}-{threading.get_ident()}.part")
            part.write_text(json.dumps([asdict(line) for line in lines], ensure_ascii=False))
            part.replace(kept)
        return lines

    def _kept(self, data: bytes) -> Path | None:
        if self._cache is None:
            return None
        return self._cache / f"{hashlib.sha256(data).hexdigest()[:40]}.{self.version}.json"

    def _look(self, image: np.ndarray) -> list[Line]:
        engine = self._load()
        found = engine(image, use_det=True, use_cls=False, use_rec=True, text_score=MIN_CONFIDENCE)
        if found.boxes is None or found.txts is None:
            return []
        lines = []
        for polygon, text, confidence in list(zip(found.boxes, found.txts, found.scores))[:MAX_LINES]:
            box = tuple(round(float(side), 1) for side in (*np.min(polygon, axis=0), *np.max(polygon, axis=0)))
            again, sure = self._second(engine, image, polygon)
            lines.append(Line(box, text.strip(), round(float(confidence), 4), again, sure))
        return lines

    def _second(self, engine: object, image: np.ndarray, polygon: np.ndarray) -> tuple[str, float]:
        """Read an enlarged, wider crop of one line by itself."""
        crop = _straightened(image, polygon)
        if crop is None:
            return "", 0.0
        read = engine(crop, use_det=False, use_cls=False, use_rec=True)  # type: ignore[operator]
        if not read.txts:
            return "", 0.0
        return read.txts[0].strip(), round(float(read.scores[0]), 4)

    def _load(self):  # type: ignore[no-untyped-def]
        if not hasattr(self._own, "engine"):
            from rapidocr import RapidOCR

            self._own.engine = RapidOCR(
                params={
                    "EngineConfig.onnxruntime.intra_op_num_threads": 1,
                    "EngineConfig.onnxruntime.inter_op_num_threads": 1,
                    "Global.log_level": "error",
                }
            )
        return self._own.engine


def _straightened(image: np.ndarray, polygon: np.ndarray) -> np.ndarray | None:
    """Cut the quadrilateral out with a margin, upright and enlarged."""
    import cv2

    corners = polygon.astype(np.float32)
    across = (np.linalg.norm(corners[1] - corners[0]) + np.linalg.norm(corners[2] - corners[3])) / 2
    down = (np.linalg.norm(corners[3] - corners[0]) + np.linalg.norm(corners[2] - corners[1])) / 2
    if across < 4 or down < 4:
        return None
    if down > 1.5 * across:  # A line that runs downwards is read turned, as the first reading does.
        corners = np.roll(corners, 1, axis=0)
        across, down = down, across
    scale = SECOND_HEIGHT_PX / down
    margin = SECOND_MARGIN * SECOND_HEIGHT_PX
    width, height = across * scale + 2 * margin, SECOND_HEIGHT_PX + 2 * margin
    goal = np.array(
        [[margin, margin], [width - margin, margin], [width - margin, height - margin], [margin, height - margin]],
        dtype=np.float32,
    )
    warp = cv2.getPerspectiveTransform(corners, goal)
    return cv2.warpPerspective(
        image, warp, (max(int(width), 8), int(height)), flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
