"""The pairs of clients/conformance."""

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from revisit_slam import Client, ProblemError, Server
from stand_in import stand_in

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
    with stand_in(lambda: (pair["response"]["status"], {}, body)) as url, Client(url) as client:
        answer = ask(client, pair)
    assert answer["verdict"] == pair["response"]["body"]["verdict"]
    assert answer["candidates"][0]["geometry"]["status"] == "dreamt"
