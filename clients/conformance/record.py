#!/usr/bin/env python3
"""Records the pairs anew from a running server: `record.py` (needs the Python package and $REVISIT_BINARY)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx

from revisit_slam import Server

PAIRS = Path(__file__).parent / "pairs"
# Differ from run to run; clients read them, tests do not compare them.
CHANGING = ["request_id", "bytes", "sqlite", "version"]
HEADERS = ["content-type", "idempotent-replayed", "etag"]


def pose(x: float) -> dict[str, Any]:
    return {"translation": {"x": x, "y": 0.0, "z": 0.0}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}


def keyframe(second: int, text: str, x: float) -> dict[str, Any]:
    return {
        "session": "robot-7",
        "stamp": {"sec": second, "nanosec": 0},
        "pose": pose(x),
        "bow": {"words": [3, 17, 42], "weights": [1.0, 1.0, 1.0]},
        "detections": [
            {"class": "door_number", "confidence": 0.9, "box": [300.0, 200.0, 340.0, 220.0], "position": [x, 0.0, 2.0], "text": text}
        ],
    }


def steps() -> list[dict[str, Any]]:
    """Return the requests in order: later ones rest on earlier ones."""
    m, k = {"map": "hotel"}, "/v1/maps/{map}/keyframes/{keyframe}"
    bad = keyframe(1, "901", 0.0)
    del bad["stamp"]
    bad["pose"]["rotation"]["w"] = 0.0

    def step(name: str, operation: str, method: str, url: str, **rest: Any) -> dict[str, Any]:
        return {"name": name, "operation": operation, "request": {"method": method, "url": url, **rest}}

    return [
        step("ready", "readyz", "GET", "/readyz"),
        step("version", "get_version", "GET", "/version"),
        step("make-a-map", "put_map", "PUT", "/v1/maps/{map}", path=m, body={"description": "a hotel", "settings": {"candidates_max": 10}}),
        step("make-it-again", "put_map", "PUT", "/v1/maps/{map}", path=m, body={"description": "a hotel", "settings": {"candidates_max": 10}}),
        step("first-keyframe", "put_keyframe", "PUT", k, path={**m, "keyframe": "kf-1"}, body=keyframe(1, "901", 0.0)),
        step("first-keyframe-again", "put_keyframe", "PUT", k, path={**m, "keyframe": "kf-1"}, body=keyframe(1, "901", 0.0)),
        step("another-body-under-its-id", "put_keyframe", "PUT", k, path={**m, "keyframe": "kf-1"}, body=keyframe(2, "901", 0.0)),
        step("two-faults-at-once", "put_keyframe", "PUT", k, path={**m, "keyframe": "kf-bad"}, body=bad),
        step("a-loop", "put_keyframe", "PUT", k, path={**m, "keyframe": "kf-2"}, query={"query": "loop"}, body=keyframe(90, "Room 901", 5.0)),
        step("a-contradiction", "query_loop", "POST", "/v1/maps/{map}/loop-queries", path=m, body={"inline": keyframe(120, "910", 15.0)}),
        step("the-stored-verdict", "query_loop", "POST", "/v1/maps/{map}/loop-queries", path=m, body={"keyframe": "kf-2", "verify": "anchors"}),
        step("a-keyframe", "get_keyframe", "GET", k, path={**m, "keyframe": "kf-2"}),
        step("its-anchor-map", "get_local_anchor_map", "GET", k + "/local-anchor-map", path={**m, "keyframe": "kf-2"}),
        step("covisible-keyframes", "list_covisible", "GET", k + "/covisible", path={**m, "keyframe": "kf-2"}),
        step("anchors", "list_anchors", "GET", "/v1/maps/{map}/anchors", path=m, query={"limit": 1}),
        step("an-anchor", "get_anchor", "GET", "/v1/maps/{map}/anchors/{anchor}", path={**m, "anchor": "a-0"}),
        step("an-old-version", "patch_anchor", "PATCH", "/v1/maps/{map}/anchors/{anchor}", path={**m, "anchor": "a-0"}, headers={"if-match": '"999"'}, body={"description": "Room 901"}),
        step("close-a-loop", "confirm_loop", "POST", "/v1/maps/{map}/loops", path=m, body={"id": "l-1", "keyframe": "kf-2", "candidate": "kf-1"}),
        step("closed-already", "query_loop", "POST", "/v1/maps/{map}/loop-queries", path=m, body={"keyframe": "kf-2"}),
        step("loops", "list_loops", "GET", "/v1/maps/{map}/loops", path=m),
        step("revoke-it", "revoke_loop", "DELETE", "/v1/maps/{map}/loops/{loop}", path={**m, "loop": "l-1"}),
        step("correct-a-pose", "correct_poses", "POST", "/v1/maps/{map}/poses", path=m, body={"session": "robot-7", "keyframes": {"ids": ["kf-2"], "poses": [pose(0.1)]}}),
        step("keyframes", "list_keyframes", "GET", "/v1/maps/{map}/keyframes", path=m, query={"limit": 10}),
        step("similar-texts", "similarity", "POST", "/v1/semantics/similarity", body={"a": "Room 901", "b": "901", "class": "door_number"}),
        step("remove-a-keyframe", "delete_keyframe", "DELETE", k, path={**m, "keyframe": "kf-2"}),
        step("no-such-keyframe", "get_keyframe", "GET", k, path={**m, "keyframe": "kf-2"}),
        step("the-map", "get_map", "GET", "/v1/maps/{map}", path=m),
        step("remove-the-map", "delete_map", "DELETE", "/v1/maps/{map}", path=m),
        step("no-such-map", "get_map", "GET", "/v1/maps/{map}", path=m),
    ]


def without_changing(value: Any) -> Any:
    """Return an answer with the fields left out that change from run to run."""
    if isinstance(value, dict):
        return {name: without_changing(inner) for name, inner in value.items() if name not in CHANGING}
    return [without_changing(inner) for inner in value] if isinstance(value, list) else value


def main() -> None:
    """Ask a fresh server, and write one file a pair."""
    PAIRS.mkdir(exist_ok=True)
    for old in PAIRS.glob("*.json"):
        old.unlink()
    with Server() as server, httpx.Client(base_url=server.url, trust_env=False) as http:
        for number, step in enumerate(steps(), 1):
            asked = step["request"]
            url = asked["url"].format(**asked.get("path", {}))
            answer = http.request(
                asked["method"], url, params=asked.get("query"), headers=asked.get("headers"), json=asked.get("body")
            )
            step["response"] = {
                "status": answer.status_code,
                "headers": {name: answer.headers[name] for name in HEADERS if name in answer.headers},
            }
            if answer.content:
                step["response"]["body"] = without_changing(answer.json())
            name = f"{number:02}-{step['name']}.json"
            (PAIRS / name).write_text(json.dumps(step, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
