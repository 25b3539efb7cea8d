"""Drives a server whose model is aimock, and counts what it was asked by aimock's journal."""

import base64
import concurrent.futures
import json
import pathlib
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zlib

SMILE = "a portrait of a lady with a mysterious smile"
LISA = "the famous Mona Lisa"
BOAT = "a painting of a small red boat on a stormy sea"
SHIP = "a picture of a red sailing ship in a storm"


def png(rgb, width=60, height=40):
    """A PNG file of one colour."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    row = b"\0" + bytes(rgb) * width
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(row * height)) + chunk(b"IEND", b"")


class Http:
    def __init__(self, url):
        self.url = url

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"content-type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                text = answer.read()
                return json.loads(text) if text else {}
        except urllib.error.HTTPError as refused:
            raise AssertionError(f"{method} {path}: {refused.code} {refused.read().decode()}") from None


class Server(Http):
    """The real binary on a database that outlives it."""

    def __init__(self, binary, database, *flags):
        arguments = ["serve", "--listen", "127.0.0.1:0", "--database", f"sqlite://{database}", "--log", "error"]
        self.process = subprocess.Popen([binary, *arguments, *flags], stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        assert line.startswith("listening on "), line
        super().__init__(line.split()[-1])

    def kill(self):
        self.process.kill()
        self.process.wait()

    def stop(self):
        self.process.terminate()
        assert self.process.wait(30) == 0


class Journal(Http):
    """The stand-in's own record of what it was asked."""

    def entries(self):
        found = self.ask("GET", "/__aimock/journal")
        found = found if isinstance(found, list) else found["entries"]
        return [entry for entry in found if "chat/completions" in entry["path"]]

    def count(self):
        return len(self.entries())

    def questions(self):
        return [json.dumps(entry["body"]["messages"], sort_keys=True) for entry in self.entries()]

    def chaos(self, **rates):
        self.ask("POST", "/__aimock/chaos", rates) if rates else self.ask("DELETE", "/__aimock/chaos")


def keyframe(second, x, *detections, covisible=()):
    return {
        "stamp": {"sec": second, "nanosec": 0},
        "pose": {"translation": {"x": x, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
        "bow": {"words": [3, 17, 42], "weights": [1, 1, 1]},
        "covisible": [{"keyframe": name, "shared": 50} for name in covisible],
        "detections": list(detections),
    }


def detection(kind, at, **more):
    return {"class": kind, "confidence": 0.9, "box": [100, 100, 160, 140], "position": at, **more}


def plate(colour, at):
    return detection("door_number", at, crop=base64.b64encode(png(colour)).decode())


def until(what, probe, seconds=60):
    """Asks until it is so."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = probe()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"never came: {what}")


def matches(server, anchor):
    return server.ask("GET", f"/v1/maps/m/anchors/{anchor}")["matches"]


def arrives(binary, work, model, journal):
    server = Server(binary, work / "arrives.db", *model)
    server.ask("PUT", "/v1/maps/m", {})
    server.ask("PUT", "/v1/maps/m/keyframes/kf-1", keyframe(1, 0, plate((200, 0, 0), [0, 0, 2]), detection("painting", [1, 0, 2], description=SMILE)))
    server.ask("PUT", "/v1/maps/m/keyframes/kf-2", keyframe(2, 0, detection("painting", [1.1, 0, 2], description=LISA), covisible=["kf-1"]))
    server.ask("PUT", "/v1/maps/m/keyframes/kf-3", keyframe(90, 50, plate((0, 0, 200), [50, 0, 2]), detection("painting", [51, 0, 2], description=LISA)))
    anchor = lambda name: server.ask("GET", f"/v1/maps/m/anchors/{name}")
    until("the description of 901", lambda: anchor("a-0").get("description") == "901")
    until("the description of 910", lambda: anchor("a-2").get("description") == "910")
    merged = until("the merged text", lambda: SMILE in (text := anchor("a-1")["description"]) and "mona lisa" in text.lower() and text)
    matched = until("the judgement", lambda: next((m for m in matches(server, "a-1") if m["source"].startswith("model:")), None))
    assert not matches(server, "a-0") and not matches(server, "a-2"), "901 is 910?"
    steps = server.ask("GET", "/v1/maps/m/anchors/a-0/transcript")["items"][0]["steps"]
    usage = server.ask("GET", "/v1/usage")
    assert usage["calls"] == journal.count(), (usage["calls"], journal.count())
    print(f"described in {len(steps)} questions, merged into {merged!r}, matched at level {matched['level']}; {usage['calls']} calls")
    server.stop()


def shares_calls(binary, work, model, journal):
    before = journal.count()
    server = Server(binary, work / "shares.db", *model)
    body = {"a": BOAT, "b": SHIP, "class": "painting"}
    ask = lambda _: server.ask("POST", "/v1/semantics/information", {"text": BOAT, "class": "painting"})
    with concurrent.futures.ThreadPoolExecutor(100) as crowd:
        answers = list(crowd.map(ask, range(100)))
    assert {answer["level"] for answer in answers} == {5} and journal.count() == before + 1, journal.count() - before
    # A 4 is asked twice: once for each order.
    server.ask("POST", "/v1/semantics/similarity", body)
    assert journal.count() == before + 3
    server.stop()
    server = Server(binary, work / "shares.db", *model)
    assert server.ask("POST", "/v1/semantics/similarity", body)["cached"]
    assert ask(0)["cached"] and journal.count() == before + 3
    server.stop()
    print("100 equal questions at once: 1 call; after a restart: none")


def survives_faults(binary, work, model, journal):
    impatient = ["--model-text-timeout-ms", "300", "--model-vision-timeout-ms", "300", "--model-retries", "1"]
    faults = {
        "429 with retry-after": dict(rateLimitRate=1),
        "500": dict(dropRate=1),
        "malformed JSON": dict(malformedRate=1),
        "a dropped connection": dict(disconnectRate=1),
        "no answer in time": dict(latencyMs=2000),
        **{mode: mode for mode in ("prose", "six", "refusal", "empty", "401", "hang")},
    }
    for number, (name, fault) in enumerate(faults.items()):
        if isinstance(fault, str):
            (work / "mode").write_text(fault)
        else:
            journal.chaos(**fault)
        server = Server(binary, work / f"faults-{number}.db", *model, *impatient)
        answer = server.ask("POST", "/v1/semantics/similarity", {"a": BOAT, "b": SHIP, "class": "painting"})
        assert answer["degraded"] and answer["level"] < 4, (name, answer)
        server.ask("PUT", "/v1/maps/m", {})
        server.ask("PUT", "/v1/maps/m/keyframes/kf-1", keyframe(1, 0, detection("painting", [0, 0, 2], description=BOAT)))
        server.ask("PUT", "/v1/maps/m/keyframes/kf-2", keyframe(90, 50, detection("painting", [50, 0, 2], description=SHIP)))
        verdict = lambda: server.ask("POST", "/v1/maps/m/loop-queries", {"keyframe": "kf-2"})
        kinds = lambda answer: [term["kind"] for term in answer["candidates"][0].get("evidence", [])]
        found = verdict()
        assert found["verdict"] != "loop" and "texts" not in kinds(found), name
        (work / "mode").write_text("")
        journal.chaos()
        until(f"the judgement after {name}", lambda: matches(server, "a-1"))
        found = verdict()
        # A picture is no name: a copy of the place would show it, too.
        assert "texts" in kinds(found) and found["verdict"] == "undecided", (name, found)
        server.stop()
    print(f"{len(faults)} faults: no request failed, no false loop, and each verdict was asked again")


def survives_kills(binary, work, model, journal):
    """The second question of a dialogue hangs, and the server is killed there."""
    before = journal.count()
    (work / "mode").write_text("hang-again")
    server = Server(binary, work / "killed.db", *model)
    server.ask("PUT", "/v1/maps/m", {})
    server.ask("PUT", "/v1/maps/m/keyframes/kf-1", keyframe(1, 0, plate((9, 9, 9), [0, 0, 2])))
    # The second call is entered in the books only once the first answer is on disk.
    until("the second question", lambda: server.ask("GET", "/v1/usage")["calls"] == 2)
    server.kill()
    (work / "mode").write_text("")
    server = Server(binary, work / "killed.db", *model)
    until("the description", lambda: server.ask("GET", "/v1/maps/m/anchors/a-0").get("description") == "903")
    asked = journal.questions()[before:]
    assert asked.count(asked[0]) == 1, f"{asked[0][:200]} was paid for twice"
    server.stop()
    print("killed within a dialogue: completed, and the answer that was stored was not asked for again")


def main():
    url, binary, work = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    journal = Journal(url)
    model = ["--model-url", f"{url}/v1", "--model-name", "stand-in", "--model-retry-delay-ms", "5", "--model-breaker-pause-ms", "50"]
    for check in (arrives, shares_calls, survives_faults, survives_kills):
        check(binary, work, model, journal)


if __name__ == "__main__":
    main()
