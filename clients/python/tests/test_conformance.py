"""The pairs of clients/conformance."""

import json
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import msgspec
import pytest

from revisit_slam import Client, ProblemError, Server

FOLDER = Path(__file__).resolve().parents[2] / "conformance"
pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="outside the checkout")


def ask(client: Client, pair: dict[str, Any]) -> Any:
    """Call the operation of a pair; return the answer, or the problem, as plain values."""
    request = pair["request"]
    arguments = list(request.get("path", {}).values()) + ([request["body"]] if "body" in request else [])
    keywords = {**request.get("query", {}), **{k.replace("-", "_"): v for k, v in request.get("headers", {}).items()}}
    try:
        answer = getattr(client, pair["operation"])(*arguments, **keywords)
        assert pair["response"]["status"] < 400, "a problem was expected"
    except ProblemError as problem:
        assert problem.status == pair["response"]["status"]
        answer = problem.problem
    return msgspec.to_builtins(answer)


def holds(found: Any, expected: Any, where: str) -> None:
    """Compare each expected field; more may be there."""
    if isinstance(expected, dict):
        for name, value in expected.items():
            assert name in found, f"{where}/{name} is missing"
            holds(found[name], value, f"{where}/{name}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), where
        for index, (one, other) in enumerate(zip(found, expected)):
            holds(one, other, f"{where}/{index}")
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, abs=1e-6), where
    else:
        assert found == expected, where


def test_every_pair_holds_against_the_running_server() -> None:
    with Server() as server, Client(server.url) as client:
        for file in sorted((FOLDER / "pairs").glob("*.json")):
            pair = json.loads(file.read_text())
            answer = ask(client, pair)
            holds(answer, pair["response"].get("body"), file.name)


@pytest.mark.parametrize("file", sorted((FOLDER / "future").glob("*.json")), ids=lambda file: file.stem)
def test_answers_of_a_newer_server_are_read(file: Path) -> None:
    pair = json.loads(file.read_text())
    body = json.dumps(pair["response"]["body"]).encode()

    class Newer(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(pair["response"]["status"])
            self.send_header("content-length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    newer = HTTPServer(("127.0.0.1", 0), Newer)
    threading.Thread(target=newer.serve_forever, daemon=True).start()
    with Client(f"http://127.0.0.1:{newer.server_port}") as client:
        answer = ask(client, pair)
    newer.shutdown()
    assert answer["verdict"] == pair["response"]["body"]["verdict"]
    assert answer["candidates"][0]["geometry"]["status"] == "dreamt"
