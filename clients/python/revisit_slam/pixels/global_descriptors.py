"""Global descriptors: one vector of a whole photograph, from a network that is installed with the reader."""

from __future__ import annotations

import base64
import hashlib
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RevisitError

MODELS = ("ppocr-det",)


# The detector of PP-OCRv6 (small), by PaddlePaddle; Apache-2.0, converted to ONNX inside rapidocr's wheel, Apache-2.0 too. It
# was trained to find text. What its backbone knows of walls and doors is a by-product, so it is no place recognition network.
MODEL = "ppocrv6-det-small-s16-1"
FILE = "PP-OCRv6_det_small.onnx"
SHA256 = "090f04abcd9d9a7498bc4ebf677e4cb9bdce1fe4197ddb7e529f1ef44e1ff94f"
# The inner result that is a descriptor's source: 192 channels at a sixteenth of the image, after the third of four stages.
RESULT = "p2o.pd_op.add.50.0"
# Width and height of the image that the network sees; multiples of 32.
SIZE_PX = (320, 192)
# Of the images that it was trained on.
_MEAN = np.array([0.485, 0.456, 0.406], dtype=np.float32)
_DEVIATION = np.array([0.229, 0.224, 0.225], dtype=np.float32)


class GlobalDescriptors:
    """Computes the vectors of photographs: of each channel its mean and its deviation over the image, as signed bytes."""

    def __init__(self, name: str) -> None:
        if name not in MODELS:
            raise RevisitError(f"--global {name}: there is {', '.join(MODELS)}")
        import onnxruntime

        options = onnxruntime.SessionOptions()
        # Results must not depend on the number of cores.
        options.intra_op_num_threads = 1
        options.log_severity_level = 3
        network = _with_result(_found(), RESULT)
        self._session = onnxruntime.InferenceSession(network, options, providers=["CPUExecutionProvider"])

    def of(self, image: np.ndarray) -> dict[str, Any]:
        """Return the descriptor of `image` (BGR), as the API takes it."""
        data = self.numbers(image).tobytes()
        return {"model": MODEL, "encoding": "int8", "data": base64.b64encode(data).decode()}

    def numbers(self, image: np.ndarray) -> np.ndarray:
        """Return the descriptor's 384 signed bytes."""
        import cv2

        small = cv2.resize(image, SIZE_PX, interpolation=cv2.INTER_AREA).astype(np.float32) / 255
        seen = ((small - _MEAN) / _DEVIATION).transpose(2, 0, 1)[None]
        (channels,) = self._session.run([RESULT], {"x": seen})
        channels = channels[0].astype(np.float64)
        vector = np.concatenate([channels.mean((1, 2)), channels.std((1, 2))])
        return np.rint(vector * (127 / max(np.abs(vector).max(), 1e-12))).astype(np.int8)


def _found() -> bytes:
    import rapidocr

    file = Path(rapidocr.__file__).parent / "models" / FILE
    try:
        data = file.read_bytes()
    except OSError as error:
        raise RevisitError(f"--global: {FILE} is not in the installed rapidocr: {error.strerror}") from error
    if hashlib.sha256(data).hexdigest() != SHA256:
        raise RevisitError(f"--global: the installed rapidocr has another {FILE}; its vectors could not be compared")
    return data


def _with_result(model: bytes, name: str) -> bytes:
    """Return an ONNX model that gives an inner result, too: serialised messages that follow each other are merged."""
    result = _field(1, name.encode())  # ValueInfoProto.name
    return model + _field(7, _field(12, result))  # ModelProto.graph, GraphProto.output


def _field(number: int, data: bytes) -> bytes:
    """Return a short field of bytes in protobuf's wire format."""
    assert len(data) < 128
    return bytes([number << 3 | 2, len(data)]) + data
