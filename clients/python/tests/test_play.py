"""revisit-play from pixels to verdicts, through its command line."""

import base64
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import zstandard

from revisit_slam import Client, Server

cv2 = pytest.importorskip("cv2")
np = pytest.importorskip("numpy")
pytest.importorskip("rapidocr")

from revisit_slam.pixels.global_descriptors import GlobalDescriptors  # noqa: E402


def play(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "revisit_slam.play", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


def lines(path: Path) -> list[dict]:
    data = zstandard.ZstdDecompressor().stream_reader(path.open("rb")).read()
    return [json.loads(line) for line in data.splitlines()]


@pytest.fixture(scope="session")
def building(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sample") / "building"
    assert play("sample", folder).returncode == 0
    return folder


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    # `check` has read the sample already.
    return Path(os.environ.get("REVISIT_SAMPLE_READINGS") or tmp_path_factory.mktemp("readings"))


@pytest.fixture(scope="session")
def first_run(building: Path, cache: Path) -> dict:
    """Play the sample building once: recording, figures and report."""
    made = building.parent
    done = play(
        "images", building, "--truth", building / "truth.csv", "--cache", cache, "--json",
        "-o", made / "first.ndjson.zst", "--report", made / "report.html",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return {**json.loads(done.stdout), "recording": made / "first.ndjson.zst", "report": made / "report.html"}


def test_every_loop_in_the_sample_building_is_right(first_run: dict) -> None:
    assert first_run["wrong"] == first_run["loops_wrong"] == 0
    assert first_run["right"] == first_run["accepted"] >= 5


def test_the_recording_replays_to_the_same_loops(first_run: dict) -> None:
    binary = os.environ["REVISIT_BINARY"]
    done = subprocess.run([binary, "replay", "--json", first_run["recording"]], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    score = json.loads(done.stdout)
    assert (score["queries"], score["accepted"], score["correct"]) == (
        first_run["queries"], first_run["accepted"], first_run["right"],
    )  # fmt: skip


def test_the_same_photographs_make_the_same_recording(first_run: dict, building: Path, cache: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.ndjson.zst"
    done = play("images", building, "--truth", building / "truth.csv", "--cache", cache, "--no-query", "-o", again, "--threads", 2)
    assert done.returncode == 0, done.stderr
    assert again.read_bytes() == first_run["recording"].read_bytes()


def test_keyframes_say_what_is_guessed(first_run: dict) -> None:
    bodies = [line["body"] for line in lines(first_run["recording"]) if line["op"] == "keyframe"]
    detections = [detection for body in bodies for detection in body.get("detections", [])]
    assert {detection["range"] for detection in detections} == {"assumed"}
    assert all(body["pose"]["translation"] == {"x": 0.0, "y": 0.0, "z": 0.0} for body in bodies)
    assert {body["bow"]["vocabulary"] for body in bodies} == {bodies[0]["bow"]["vocabulary"]}
    assert base64.b64decode(detections[0]["crop"])[:2] == b"\xff\xd8"
    assert len({body["session"] for body in bodies}) >= 6


def test_the_report_needs_no_other_file(first_run: dict) -> None:
    page = first_run["report"].read_text()
    assert page.count("<article class=loop>") == first_run["accepted"]
    assert "<article class=none>" in page
    # A loop shows what decided, and accuses itself of nothing.
    loops = page.split("<h2>")[1]
    assert "Both read" in loops and "against" not in loops and "hung" not in loops
    assert not re.search(r"(?:src|href)=(?!'data:)", page)


def test_a_running_server_is_used_and_its_map_not_mixed(building: Path, cache: Path) -> None:
    with Server() as server, Client(server.url) as client:
        arguments = ("images", building, "--cache", cache, "--server", server.url, "--map", "twin", "--features")
        done = play(*arguments)
        assert done.returncode == 0, done.stderr
        assert "why not" in done.stdout
        assert f"viewer: {server.url}/?map=twin" in done.stderr
        stored = client.get_keyframe("twin", "visit1_frame_0001")
        assert stored.features is not None and stored.camera is not None and stored.camera.fx == 600
        again = play(*arguments)
        assert again.returncode == 1 and "map twin has" in again.stderr and again.stderr.count("\n") == 1


def test_the_global_descriptor_of_a_photograph_is_sent_and_the_next_one_is_alike(building: Path, tmp_path: Path) -> None:
    photographs = sorted(building.glob("*.jpg"))
    recording, few = tmp_path / "globals.ndjson.zst", tmp_path / "few"
    few.mkdir()
    shutil.copy(photographs[0], few)
    assert play("images", few, "--no-query", "--global", "ppocr-det", "-o", recording).returncode == 0
    (sent,) = (line["body"]["global_descriptor"] for line in lines(recording) if line["op"] == "keyframe")
    assert (sent["model"], sent["encoding"]) == ("ppocrv6-det-small-s16-1", "int8")
    model = GlobalDescriptors("ppocr-det")
    numbers = np.array([model.numbers(cv2.imread(str(file))) for file in photographs[:12]], dtype=np.float64)
    assert base64.b64decode(sent["data"]) == numbers[0].astype(np.int8).tobytes()
    unit = numbers / np.linalg.norm(numbers, axis=1, keepdims=True)
    alike = unit @ unit.T
    assert np.median(np.diag(alike, 1)) > np.median(alike[np.triu_indices(len(numbers), 2)])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("images", "nowhere"), "nowhere: no such folder"),
        (("images", "{empty}"), "no photographs in it"),
        (("images", "{broken}", "--no-query", "-o", "{tmp}/o.ndjson"), "nothing to play; left out 1: not a picture"),
        (("images", "{building}", "--truth", "{broken}/truth.csv"), "no columns `frame` and `floor`"),
        (("images", "{building}", "--truth", "{short}/truth.csv"), "no floor for visit1_frame_0001.jpg"),
        (("images", "{building}", "--map", "a/b"), "--map a/b"),
        (("images", "{building}", "--focal-px", "-3"), "--focal-px"),
        (("images", "{building}", "--threads", "0"), "--threads 0"),
        (("images", "{building}", "--global", "megaloc"), "--global megaloc"),
        (("images", "{building}", "--report", "{tmp}/no/report.html"), "--report"),
        (("images", "{building}", "--set", "candidates_max"), "--set candidates_max"),
        (("images", "{building}", "--set", "candidates_maximum=3"), "/settings/candidates_maximum"),
        (("images", "{building}", "--server", "http://127.0.0.1:9"), "no answer from http://127.0.0.1:9"),
        (("sample", "{building}"), "must be a new or an empty folder"),
    ],
)
def test_bad_input_is_one_clear_line(arguments: tuple[str, ...], told: str, building: Path, tmp_path: Path) -> None:
    folders = {name: tmp_path / name for name in ("empty", "broken", "short")}
    for folder in folders.values():
        folder.mkdir()
    (folders["broken"] / "bad_1.jpg").write_bytes(b"no picture")
    (folders["broken"] / "truth.csv").write_text("name,level\na,1\n")
    (folders["short"] / "truth.csv").write_text("frame,floor\nvisit1_frame_0002.jpg,1\n")
    named = {**{name: str(path) for name, path in folders.items()}, "building": str(building), "tmp": str(tmp_path)}
    done = play(*(argument.format(**named) for argument in arguments))
    assert done.returncode == 1
    assert told in done.stderr and done.stderr.count("\n") == 1, done.stderr
