"""One request to the server, before it is sent, and its answer's decoding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import quote

import msgspec
import zstandard

from .errors import RevisitError


class UnexpectedAnswer(RevisitError):
    """An answer of another shape than the document's, such as a proxy's page."""


# Smaller bodies gain nothing from compression.
MIN_COMPRESSED_BYTES = 1024
MAX_RATIO = 60
# POST operations that make something new each time: repeated only if the first try cannot have arrived.
NOT_REPEATABLE = {("POST", "/v1/keys"), ("POST", "/v1/backups")}


def segment(value: str) -> str:
    """Return an id as one segment of a path."""
    return quote(value, safe="._:-")


@dataclass(frozen=True)
class Call:
    """Method, path, query, headers, body and the type of the answer."""

    method: str
    path: str
    query: Mapping[str, Any] = field(default_factory=dict)
    headers: Mapping[str, Any] = field(default_factory=dict)
    body: Any = None
    answer: Any = None
    content_type: str = "application/json"

    @property
    def repeatable(self) -> bool:
        """Whether a second sending is harmless even if the first arrived."""
        return (self.method, self.path) not in NOT_REPEATABLE

    def content(self, compress: bool) -> tuple[bytes | None, dict[str, str]]:
        """Return the bytes of the body and the headers of the request."""
        headers = {name: str(value) for name, value in self.headers.items() if value is not None}
        if self.body is None:
            return None, headers
        data = self.body if isinstance(self.body, bytes) else msgspec.json.encode(self.body)
        headers["content-type"] = self.content_type
        if compress and len(data) >= MIN_COMPRESSED_BYTES:
            smaller = zstandard.ZstdCompressor(level=1).compress(data)
            # The server refuses a body that becomes more than 64 times its size.
            if len(data) < MAX_RATIO * len(smaller):
                headers["content-encoding"] = "zstd"
                data = smaller
        return data, headers

    def params(self) -> dict[str, str]:
        """Return the query parameters that are set, booleans as JSON writes them."""
        return {
            name: ("true" if value else "false") if isinstance(value, bool) else str(value)
            for name, value in self.query.items()
            if value is not None
        }

    def decode(self, data: bytes) -> Any:
        """Return the answer as its type."""
        if self.answer is None:
            return None
        if self.answer is bytes:
            return data
        if self.answer is str:
            return data.decode()
        try:
            return msgspec.json.decode(data, type=Any if self.answer is dict else self.answer)
        except msgspec.DecodeError as error:
            raise UnexpectedAnswer(f"{self.method} {self.path} was not answered as the API document says: {error}") from error
