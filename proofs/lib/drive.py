"""Drives two robots through one place, closes the loop between them with the query that found it, and keeps what the
server says of it: the first one's trajectory in three formats, its truth, and the loop's own answer."""

import base64
import json
import sys
import urllib.request
from pathlib import Path

import numpy as np

STEPS = 12
POINTS = 300
CAMERA = {"fx": 500.0, "fy": 500.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480}
# Where the second robot's frame lies in the first one's.
YAW, SHIFT = 0.4, np.array([3.0, 0.2, -1.0])


def turned(yaw: float) -> np.ndarray:
    return np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])


def drive(base: str, out: Path) -> None:
    def ask(method: str, path: str, body: object = None) -> bytes:
        request = urllib.request.Request(
            base + path, None if body is None else json.dumps(body).encode(), {"content-type": "application/json"}, method=method
        )
        with urllib.request.urlopen(request) as answer:
            return answer.read()

    rng = np.random.default_rng(3)
    # A place 4 to 8 m ahead of the last keyframe, and nothing that looks like it anywhere else.
    places = rng.uniform((-2, -1.5, 4), (2, 1.5, 8), (POINTS, 3)) + (0, 0, 0.5 * STEPS)
    looks = rng.integers(0, 256, (POINTS, 32), np.uint8)
    ask("PUT", "/v1/maps/drive", {})
    truth = []
    for robot, (yaw, shift) in enumerate(((0.0, np.zeros(3)), (YAW, SHIFT))):
        for step in range(STEPS):
            # In the first robot's frame; the second one stands a little aside and looks a little to the left.
            at, look = np.array([0.3 * robot, 0.0, 0.5 * (step + 1)]), 0.02 * step - 0.06 * robot
            own_at, own_look = turned(yaw).T @ (at - shift), look - yaw
            body = {
                "session": f"robot-{robot + 1}",
                "stamp": {"sec": 100 * robot + step, "nanosec": 250_000_000},
                "pose": {
                    "translation": dict(zip("xyz", own_at)),
                    "rotation": {"x": 0, "y": np.sin(own_look / 2), "z": 0, "w": np.cos(own_look / 2)},
                },
                "camera": CAMERA,
                "bow": {"words": [step + 1], "weights": [1]},
            }
            if step == STEPS - 1:
                body |= seen(places, looks, at, look, (yaw, shift), rng)
            ask("PUT", f"/v1/maps/drive/keyframes/r{robot + 1}-{step}", body)
            if robot == 0:
                truth.append(f"{step}.25 {at[0]} {at[1]} {at[2]} 0 {np.sin(look / 2)} 0 {np.cos(look / 2)}")
    last = STEPS - 1
    answer = json.loads(ask("POST", "/v1/maps/drive/loop-queries", {"keyframe": f"r2-{last}"}))
    assert (answer["verdict"], answer["best"]) == ("loop", f"r1-{last}"), answer
    ask("POST", "/v1/maps/drive/loops", {"id": "l-1", "keyframe": f"r2-{last}", "candidate": f"r1-{last}", "query": answer["id"]})
    # A loop that no query found has no transformation.
    ask("POST", "/v1/maps/drive/loops", {"id": "l-2", "keyframe": "r2-3", "candidate": "r1-3"})
    for form in ("tum", "kitti"):
        (out / f"drive.{form}").write_bytes(ask("GET", f"/v1/maps/drive/trajectory?format={form}&session=robot-1"))
    (out / "drive.g2o").write_bytes(ask("GET", "/v1/maps/drive/trajectory?format=g2o"))
    (out / "truth.tum").write_text("\n".join(truth) + "\n")
    (out / "answer.json").write_text(json.dumps(answer))
    (out / "poses").write_text(str(STEPS))


def seen(places, looks, at, look, frame, rng) -> dict:
    """What a camera sees of the place, in pixels with noise, with the points in its robot's own frame."""
    yaw, shift = frame
    in_camera = (places - at) @ turned(look)
    pixels = in_camera[:, :2] / in_camera[:, 2:] * 500 + (320, 240) + rng.normal(0, 0.5, (len(places), 2))
    there = (in_camera[:, 2] > 0.5) & (pixels > 0).all(1) & (pixels < (640, 480)).all(1)
    # A depth camera: points are as far off as a centimetre.
    own = (places + rng.normal(0, 0.01, places.shape) - shift) @ turned(yaw)
    ids = [int(id) for id in np.nonzero(there)[0]]
    middle = (np.array([0, 0, 6.0 + 0.5 * STEPS]) - shift) @ turned(yaw)
    return {
        "features": {
            "descriptor_bytes": 32,
            "descriptors": base64.b64encode(looks[there].tobytes()).decode(),
            "keypoints": [[u, v, 0, 0] for u, v in pixels[there].round(3).tolist()],
            "map_points": ids,
        },
        "map_points": {"ids": ids, "positions": own[there].tolist()},
        "detections": [
            {"class": "door_number", "confidence": 0.95, "box": [300, 200, 340, 240], "text": "901", "position": middle.tolist()}
        ],
    }


if __name__ == "__main__":
    drive(sys.argv[1], Path(sys.argv[2]))
