"""A robot with odometry and a reader of plates, without map points: two laps around a block with four plates.

    python two_laps.py [http://127.0.0.1:7878]

It sends no `covisible`, so the server takes the keyframes near along the drive as neighbours. Each answer `loop` is confirmed,
which makes the two sights of the plate one. The map is one of its own, `example-two-laps`, made anew. $REVISIT_KEY is the key of
a server that has keys.
"""

import os
import sys
from collections.abc import Iterator
from typing import Any

from revisit_slam import Client, ProblemError, Retries, ServerUnreachable

PLATES = [("901", [4, 0, -1]), ("903", [9, 0, 4]), ("905", [4, 0, 9]), ("907", [-1, 0, 4])]
SIDE_M = 8
MAP = "example-two-laps"


def keyframes(laps: int) -> Iterator[dict[str, Any]]:
    """Yield keyframes a metre and a second apart, around a block of 8 m by 8 m."""
    for second in range(laps * 4 * SIDE_M):
        side, along = divmod(second % (4 * SIDE_M), SIDE_M)
        x, z = [(along, 0), (SIDE_M, along), (SIDE_M - along, SIDE_M), (0, SIDE_M - along)][side]
        text, position = PLATES[side]
        plate = {"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": position, "text": text}
        yield {
            "session": "robot-7",
            "stamp": {"sec": second, "nanosec": 0},
            "pose": {"translation": {"x": x, "y": 0, "z": z}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "bow": {"words": [3, 17, 42], "weights": [1, 1, 1]},
            "detections": [plate] if 3 <= along <= 5 else [],
        }


def drive(client: Client) -> None:
    """Drive two laps, and close each loop that the server answers."""
    try:
        client.delete_map(MAP)
    except ProblemError as error:
        if error.code != "not_found":
            raise
    client.put_map(MAP, {})
    for number, keyframe in enumerate(keyframes(laps=2)):
        verdict = client.put_keyframe(MAP, f"kf-{number}", keyframe, query="loop").loop
        if verdict and verdict.verdict == "loop":
            print(f"kf-{number} is at {verdict.best}: {verdict.why}")
            client.confirm_loop(MAP, {"id": f"loop-{number}", "keyframe": f"kf-{number}", "candidate": verdict.best})
    seen = client.get_map(MAP)
    print(f"{seen.keyframes} keyframes, {seen.anchors} signs, {seen.loops} loops")


def main() -> None:
    """Say at once where no server answers, or one refuses."""
    url = sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:7878"
    try:
        with Client(url, key=os.environ.get("REVISIT_KEY"), retries=Retries(total_s=2)) as client:
            drive(client)
    except ServerUnreachable as error:
        sys.exit(f"No server is ready at {url} ({error}). Start one with: revisit serve")
    except ProblemError as error:
        sys.exit(f"{url} refuses: {error}")


main()
