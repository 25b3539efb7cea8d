"""Limits: how much one file may bring. The server's own are the same or higher."""

from __future__ import annotations

# Keyframes of one file; each costs some hundred bytes while it is read.
MAX_KEYFRAMES = 1_000_000
# Of one keyframe, as the server takes them.
MAX_FEATURES = 20_000
MAX_OBSERVED_POINTS = 100_000
MAX_COVISIBLE = 10_000
MAX_DETECTIONS = 500
# The server's, of every coordinate: to the Sun is farther, no building is.
MAX_COORDINATE_M = 1e9
# One text line, blob or object of a file: a keyframe of 20,000 features takes a tenth of it.
MAX_PIECE_BYTES = 64 << 20
MAX_POINT_ID = 2**63 - 1
