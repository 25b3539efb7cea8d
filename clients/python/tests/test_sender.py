"""The sender through outages."""

from pathlib import Path

from revisit_slam import Client, KeyframeSender, Server
from samples import keyframe


def stored(client: Client, map_id: str) -> list[str]:
    """Return the ids of a map's keyframes in the order of arrival: each described an anchor of its own."""
    texts = []
    for event in client.listen(map_id, stop_when_idle_s=3.0):
        if event.event == "anchor_described":
            anchor = client.get_anchor(map_id, event.anchor or "")
            texts.append(anchor.keyframes[0])
    return texts


def numbered(number: int) -> dict[str, object]:
    """Return a keyframe far from all others with a plate of its own."""
    return keyframe(number, str(100 + number), 50.0 * number)


def test_everything_arrives_in_order(client: Client, map_id: str) -> None:
    with KeyframeSender(client, map_id) as sender:
        for number in range(300):
            assert sender.put(f"kf-{number}", numbered(number))
        assert sender.flush(30)
        stats = sender.stats()
    assert (stats.sent, stats.refused, stats.dropped, stats.queued, stats.spilled) == (300, 0, 0, 0, 0)
    assert stored(client, map_id) == [f"kf-{number}" for number in range(300)]


def test_an_outage_loses_nothing_and_spills_in_order(tmp_path: Path) -> None:
    database = tmp_path / "revisit.db"
    first = Server(database)
    port = first.url.rsplit(":", 1)[1]
    client = Client(first.url)
    client.put_map("m", {})
    sender = KeyframeSender(client, "m", spill=tmp_path / "spill.ndjson", queue_keyframes=50)
    sender.put("kf-0", numbered(0))
    assert sender.flush(30)
    first.stop()
    for number in range(1, 400):
        while not sender.put(f"kf-{number}", numbered(number)):
            raise AssertionError("dropped within the bounds")
        while len(sender._incoming) > 60:  # A burst of 400 in no time: let the spilling thread have its turn.
            pass
    assert sender.stats().lag_s > 0
    with Server(database, listen=f"127.0.0.1:{port}"):
        assert sender.flush(60)
        assert sender.stats().dropped == 0 and sender.stats().sent == 400
        assert stored(client, "m") == [f"kf-{number}" for number in range(400)]
        assert sender.close() == 0
    assert not (tmp_path / "spill.ndjson").exists()


def test_unsent_keyframes_are_sent_by_the_next_sender(tmp_path: Path, client: Client, map_id: str) -> None:
    spill = tmp_path / "spill.ndjson"
    nowhere = KeyframeSender(Client("http://127.0.0.1:9"), map_id, spill=spill, queue_keyframes=5)
    for number in range(9):
        nowhere.put(f"kf-{number}", numbered(number))
    assert nowhere.close(timeout_s=0.2) == 9
    with KeyframeSender(client, map_id, spill=spill) as sender:
        assert sender.flush(30) and sender.stats().sent == 9


def test_beyond_all_bounds_it_counts_what_it_drops(tmp_path: Path) -> None:
    sender = KeyframeSender(
        Client("http://127.0.0.1:9"), "m", spill=tmp_path / "spill.ndjson", queue_keyframes=5, spill_bytes=2000
    )
    taken = sum(sender.put(f"kf-{number}", numbered(number)) for number in range(200))
    left = sender.close(timeout_s=0.2)
    assert taken <= 200 and left + sender.stats().dropped == 200


def test_a_refused_keyframe_is_told_and_holds_nothing_up(client: Client, map_id: str) -> None:
    told = []
    with KeyframeSender(client, map_id, on_line=told.append) as sender:
        bad = keyframe(2)
        bad["pose"]["rotation"]["w"] = 0
        for id, body in (("kf-1", keyframe(1)), ("kf-2", bad), ("kf-3", keyframe(3))):
            sender.put(id, body)
        assert sender.flush(30)
        assert sender.stats().sent == 2 and sender.stats().refused == 1
    assert [line.id for line in told if line.problem is not None] == ["kf-2"]
