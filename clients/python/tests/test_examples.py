"""The programs in `examples/`, as a stranger runs them."""

import subprocess
import sys
from pathlib import Path

from revisit_slam import Server

TWO_LAPS = Path(__file__).resolve().parents[1] / "examples" / "two_laps.py"


def run(url: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, TWO_LAPS, url], capture_output=True, text=True)


def test_two_laps_close_each_place_once_and_can_be_driven_again(server: Server) -> None:
    for done in (run(server.url), run(server.url)):
        assert done.stdout.splitlines()[-1] == "64 keyframes, 4 signs, 4 loops", done


def test_a_server_that_is_not_there_is_named_with_how_to_start_one() -> None:
    done = run("http://127.0.0.1:1")
    assert done.returncode == 1 and "http://127.0.0.1:1" in done.stderr and "revisit serve" in done.stderr, done
