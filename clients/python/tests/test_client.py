"""The client against the real server."""

import asyncio
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from revisit_slam import AsyncClient, Client, KeyframeSender, ProblemError, Retries, RevisitError, Server, ServerUnreachable
from revisit_slam import models
from samples import keyframe
from stand_in import stand_in

TOOLS = Path(__file__).resolve().parents[1] / "tools"
DOCUMENT = Path(__file__).resolve().parents[3] / "openapi" / "openapi.yaml"


@pytest.mark.skipif(not DOCUMENT.exists(), reason="outside the checkout")
def test_generated_files_are_those_of_the_document() -> None:
    done = subprocess.run([sys.executable, TOOLS / "generate.py", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_operation_of_the_running_server_is_a_method(client: Client) -> None:
    for path, methods in client.get_document()["paths"].items():
        for operation in methods.values():
            name = operation["operationId"]
            assert hasattr(Client, name) and hasattr(AsyncClient, name), (name, path)


def test_a_loop_is_found_and_its_look_alike_rejected(client: Client, map_id: str) -> None:
    client.put_keyframe(map_id, "kf-1", keyframe(1, "901"))
    asked = client.put_keyframe(map_id, "kf-2", keyframe(90, "Room 901", 5.0), query="loop")
    assert asked.loop is not None and asked.loop.verdict == models.Verdict.LOOP and asked.loop.best == "kf-1"
    other = client.query_loop(map_id, {"inline": keyframe(120, "910", 15.0)})
    assert other.verdict == "no_loop"
    assert {candidate.reason.code for candidate in other.candidates if candidate.reason} == {"contradiction"}
    closed = client.confirm_loop(map_id, {"id": "l-1", "keyframe": "kf-2", "candidate": "kf-1"})
    assert [merge.from_ for merge in closed.merged]
    assert client.get_keyframe(map_id, "kf-2").detections[0].text == "Room 901"
    assert client.list_loops(map_id).items[0].candidate == "kf-1"
    assert client.revoke_loop(map_id, "l-1").split


def test_an_exported_map_is_made_again_from_its_lines(client: Client, server: Server, map_id: str) -> None:
    client.put_keyframe(map_id, "kf-1", keyframe(1, "901"))
    client.put_keyframe(map_id, "kf-2", keyframe(90, "Room 901", 5.0))
    client.confirm_loop(map_id, {"id": "l-1", "keyframe": "kf-2", "candidate": "kf-1"})
    lines = [msgspec.json.decode(line) for line in client.export_map(map_id)]
    assert [line["op"] for line in lines] == ["map", "keyframe", "keyframe", "loop"]
    copy = f"{map_id}-again"
    client.put_map(copy, lines[0]["body"])
    for line in lines[1:3]:
        client.put_keyframe(copy, line["id"], line["body"])
    client.confirm_loop(copy, lines[3]["body"])

    async def again() -> list[bytes]:
        async with AsyncClient(server.url) as waiting:
            return [line async for line in waiting.export_map(copy)]

    assert [msgspec.json.decode(line) for line in asyncio.run(again())][1:] == lines[1:]
    with pytest.raises(ProblemError) as raised:
        list(client.export_map("nowhere"))
    assert raised.value.status == 404


def test_a_struct_and_a_dict_are_the_same_body(client: Client, map_id: str) -> None:
    plain = keyframe(1, "901")
    client.put_keyframe(map_id, "kf-1", plain)
    typed = msgspec.convert(plain, models.Keyframe)
    assert client.put_keyframe(map_id, "kf-1", typed).keyframe == "kf-1"
    assert client.get_map(map_id).keyframes == 1


def test_a_refusal_names_every_fault(client: Client, map_id: str) -> None:
    bad = keyframe(1)
    del bad["stamp"]
    bad["pose"]["rotation"]["w"] = 0
    with pytest.raises(ProblemError) as raised:
        client.put_keyframe(map_id, "kf-1", bad)
    assert raised.value.code == "invalid" and raised.value.status == 422
    assert {fault.pointer for fault in raised.value.errors} == {"/stamp", "/pose/rotation"}
    del bad["pose"]
    bad["stamp"] = {"sec": "soon", "nanosec": 0}
    bad |= {"pose": keyframe(1)["pose"]}
    with pytest.raises(ProblemError) as one:
        client.put_keyframe(map_id, "kf-1", bad)
    assert str(one.value).count(one.value.errors[0].detail) == 1, "its sentence is told once"
    with pytest.raises(ProblemError) as missing:
        client.get_map("nowhere")
    assert missing.value.code == "not_found"


def test_an_etag_guards_a_description(client: Client, map_id: str) -> None:
    anchor = client.put_keyframe(map_id, "kf-1", keyframe(1, "901")).detections[0].anchor
    assert anchor is not None
    version = client.get_anchor(map_id, anchor).version
    changed = client.patch_anchor(map_id, anchor, {"description": "Room 902"}, if_match=f'"{version}"')
    assert changed.description == "Room 902"
    with pytest.raises(ProblemError) as raised:
        client.patch_anchor(map_id, anchor, {"description": "Room 903"}, if_match=f'"{version}"')
    assert raised.value.status == 412


def test_bulk_takes_a_generator_and_tells_of_each_item(client: Client, map_id: str) -> None:
    items = ({"id": f"kf-{number}", **keyframe(number)} for number in range(600))
    lines = list(client.put_keyframes(map_id, items))
    assert [line.status for line in lines] == [201] * 600
    assert [line.line for line in lines] == list(range(1, 601))
    again = list(client.put_keyframes(map_id, [{"id": "kf-7", **keyframe(8)}, {"id": "kf-8", **keyframe(8)}]))
    assert [line.status for line in again] == [409, 200]
    assert again[0].problem is not None and again[0].problem.code == "keyframe_exists"


def test_events_arrive_in_order_and_resume(client: Client, map_id: str) -> None:
    anchors = [
        client.put_keyframe(map_id, f"kf-{number}", keyframe(number, f"90{number}", 20.0 * number)).detections[0].anchor
        for number in range(5)
    ]
    first = list(client.listen(map_id, stop_when_idle_s=3.0))
    assert [event.anchor for event in first if event.event == "anchor_described"] == anchors
    rest = list(client.listen(map_id, since=first[2].seq, stop_when_idle_s=3.0))
    assert [event.seq for event in rest] == [event.seq for event in first[3:]]


def test_events_resume_when_the_server_comes_back(tmp_path: Path) -> None:
    database = tmp_path / "revisit.db"
    with Server(database) as running:
        port = running.url.rsplit(":", 1)[1]
        with Client(running.url) as client:
            client.put_map("m", {})
            first = client.put_keyframe("m", "kf-1", keyframe(1, "901")).detections[0].anchor
            seen = (event for event in client.listen("m") if event.event == "anchor_described")
            assert next(seen).anchor == first
            running.stop()
            with Server(database, listen=f"127.0.0.1:{port}"):
                second = client.put_keyframe("m", "kf-2", keyframe(2, "917", 40.0)).detections[0].anchor
                assert next(seen).anchor == second


def test_the_async_client_does_the_same(server: Server, map_id: str) -> None:
    async def drive() -> tuple[list[int], list[str], str]:
        async with AsyncClient(server.url) as client:
            async def items():  # type: ignore[no-untyped-def]
                for number in range(3):
                    yield {"id": f"kf-{number}", **keyframe(number, f"90{number}", 20.0 * number)}

            lines = [line.status async for line in client.put_keyframes(map_id, items())]
            events = [event.event async for event in client.listen(map_id, stop_when_idle_s=3.0)]
            try:
                await client.get_map("nowhere")
            except ProblemError as problem:
                return lines, events, problem.code
            raise AssertionError("a map that is not there")

    assert asyncio.run(drive()) == ([201] * 3, ["keyframe_stored", "anchor_described"] * 3, "not_found")


def test_sync_and_async_have_the_same_signatures() -> None:
    for name, method in inspect.getmembers(Client, inspect.isfunction):
        if name.startswith("_") or name == "once":
            continue
        ours, theirs = inspect.signature(method), inspect.signature(getattr(AsyncClient, name))
        assert list(ours.parameters) == list(theirs.parameters), name


def test_a_busy_server_is_asked_again_and_unknown_values_are_read() -> None:
    busy = (503, {"retry-after": "0.05"}, b"")
    newer = b'{"verdict":"maybe","id":"q-1","map_version":1,"best":null,"loops":[],"degraded":false,'
    newer += b'"excluded_covisible":0,"closed":[],"candidates":[],"weather":"fine"}'
    answers = iter([busy, busy, (200, {}, newer)])
    with stand_in(lambda: next(answers)) as url, Client(url, key="secret") as client:
        answer = client.get_loop_query("m", "q-1")
    assert not list(answers)
    assert answer.verdict == "maybe" and not answer.verdict.known
    assert models.Verdict.LOOP.known


def test_a_server_that_is_not_there_is_one_clear_error() -> None:
    with Client("http://127.0.0.1:9", retries=Retries(total_s=0)) as client, pytest.raises(ServerUnreachable) as raised:
        client.readyz()
    assert "127.0.0.1:9" in str(raised.value)


@pytest.mark.parametrize(
    ("told", "base"),
    [
        ("localhost:7878", "http://localhost:7878"),
        (" 127.0.0.1:7878\n", "http://127.0.0.1:7878"),
        ("host", "http://host"),
        ("[::1]:7878", "http://[::1]:7878"),
        ("http://host:7878//", "http://host:7878"),
        ("https://robots.example/revisit/", "https://robots.example/revisit"),
        ("robots.example/a/b", "http://robots.example/a/b"),
        *((wrong, None) for wrong in (
            "", "  ", "/", "http://", "http:", "http:/host", "http//host:7878", "ftp://x", "://x", ":7878", "7878",
            "localhost:port", "localhost:99999", "local host:7878", "http://[::1", "http://a..b", "http://host/?map=m", "*",
        )),
    ],
)  # fmt: skip
def test_an_address_is_taken_as_a_person_writes_it_or_refused_by_its_name(told: str, base: str | None) -> None:
    for made in (Client, AsyncClient):
        if base is not None:
            assert str(made(told)._http.base_url).rstrip("/") == base
            continue
        with pytest.raises(RevisitError) as raised:
            made(told)
        assert repr(told) in str(raised.value) and "http://127.0.0.1:7878" in str(raised.value)


def test_an_address_without_a_scheme_and_one_with_a_path_reach_the_server(server: Server) -> None:
    with Client(f" {server.url.removeprefix('http://')}/ ") as client:
        assert client.get_document()["openapi"]
    with Client("robots.example/revisit/") as client:
        assert str(client._http.build_request("GET", "/v1/maps").url) == "http://robots.example/revisit/v1/maps"


PROXIES = ("http_proxy", "HTTP_PROXY", "https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY", "no_proxy", "NO_PROXY")


@pytest.fixture
def environment(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """An environment without any proxy."""
    for name in PROXIES:
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


def made(url: str, tmp_path: Path) -> None:
    """Make each class of client."""
    with Client(url, retries=Retries(total_s=0)) as client:
        KeyframeSender(client, "m", spill=tmp_path / "spill").close(0)
    asyncio.run(AsyncClient(url).close())


@pytest.mark.parametrize(
    ("proxy", "cure"),
    [
        ("socks5://me:secret@127.0.0.1:1080", "pip install 'httpx[socks]'"),
        ("socks5h://127.0.0.1:1080", "NO_PROXY=robot.example"),
        ("socks4://127.0.0.1:1080", "http://HOST:PORT"),
        ("ftp://127.0.0.1:21", "http://HOST:PORT"),
        ("http://[::1", "http://HOST:PORT"),
        ("http://127.0.0.1:port", "http://HOST:PORT"),
        ("http://", "http://HOST:PORT"),
    ],
)
def test_a_proxy_that_cannot_be_used_is_told_with_its_cure_where_it_is_on_the_way(
    proxy: str, cure: str, environment: pytest.MonkeyPatch, tmp_path: Path, server: Server
) -> None:
    if proxy.startswith("socks5") and importlib.util.find_spec("socksio"):
        pytest.skip("socks is there")
    for name, scheme in (("ALL_PROXY", "https"), ("all_proxy", "http"), ("http_proxy", "http"), ("https_proxy", "https")):
        for other in PROXIES:
            environment.delenv(other, raising=False)
        environment.setenv(name, proxy)
        for make in (Client, AsyncClient):
            with pytest.raises(RevisitError) as raised:
                make(f"{scheme}://robot.example:7878")
            told = str(raised.value)
            assert name.upper() in told and cure in told and "NO_PROXY=robot.example" in told and "secret" not in told
        made(server.url, tmp_path)
        made("http://localhost:7878", tmp_path)
        environment.setenv("NO_PROXY", "robot.example")
        made(f"{scheme}://robot.example:7878", tmp_path)
    for name in PROXIES:
        environment.delenv(name, raising=False)
    environment.setenv("https_proxy", proxy)
    made("http://robot.example", tmp_path)


@pytest.mark.parametrize(
    ("url", "names", "is_named"),
    [
        ("http://robot.example:7878", "*", True),
        ("http://robot.example:7878", "a, *", True),
        ("http://robot.example:7878", "Robot.Example", True),
        ("http://robot.example:7878", "other, .example", True),
        ("http://robot.example:7878", "*.example", True),
        ("http://robot.example:7878", "other example", True),
        ("http://robot.example:7878", "robot.example:7878", True),
        ("http://robot.example:7878", "robot.example:80", False),
        ("http://robot.example", "robot.example:80", True),
        ("https://robot.example", "https://robot.example:443", True),
        ("http://robot.example:7878", "ot.example", False),
        ("http://robot.example:7878", ",", False),
        ("http://10.1.2.3:7878", "10.0.0.0/8", True),
        ("http://10.1.2.3:7878", "10.1.2.3", True),
        ("http://10.1.2.3:7878", "10.1.2.3:7878", True),
        ("http://10.1.2.3:7878", "192.168.0.0/16,10.1.2.4", False),
        ("http://[fd00::1]:7878", "fd00::/8", True),
        ("http://[fd00::1]:7878", "[fd00:0::1]:7878", True),
        ("http://[fd00::1]:7878", "fd01::1", False),
        ("http://127.0.0.2:7878", "", True),
        ("http://[::1]:7878", "", True),
    ],
)
def test_no_proxy_holds_in_each_of_its_forms(url: str, names: str, is_named: bool, environment: pytest.MonkeyPatch) -> None:
    environment.setenv("ALL_PROXY", "socks4://127.0.0.1:1")
    environment.setenv("no_proxy", names)
    if is_named:
        Client(url).close()
        return
    with pytest.raises(RevisitError, match="ALL_PROXY"):
        Client(url)


def test_a_proxy_on_the_way_is_asked_and_named_when_it_is_down(environment: pytest.MonkeyPatch) -> None:
    # Nobody knows robot.example: only the proxy can have answered.
    with stand_in(lambda: (200, {}, b'{"openapi":"3"}')) as url:
        environment.setenv("http_proxy", url.removeprefix("http://"))
        with Client("robot.example:7878", retries=Retries(total_s=0)) as client:
            assert client.get_document() == {"openapi": "3"}

        async def wait() -> None:
            async with AsyncClient("robot.example:7878/api", retries=Retries(total_s=0)) as client:
                assert await client.get_document() == {"openapi": "3"}

        asyncio.run(wait())
    with Client("robot.example:7878", retries=Retries(total_s=0)) as client, pytest.raises(ServerUnreachable) as raised:
        client.readyz()
    assert url in str(raised.value) and "NO_PROXY=robot.example" in str(raised.value)


def test_certificates_that_are_not_there_are_told_for_https_only(environment: pytest.MonkeyPatch, tmp_path: Path) -> None:
    environment.setenv("SSL_CERT_FILE", str(tmp_path / "none.pem"))
    Client("http://robot.example").close()
    for make in (Client, AsyncClient):
        with pytest.raises(RevisitError, match="SSL_CERT_FILE"):
            make("https://robot.example")
