"""Whether a history of writes and reads is one that a single map could have had.

Each accepted change of a map makes the next version, and a read returns one. So the order of the operations is known: by version,
a write before the reads of its version. The history is linearizable (Herlihy and Wing, 1990) if and only if that order never
contradicts real time, which is found by one pass over the operations sorted by time.
"""

import math
import random
from dataclasses import dataclass, field

# A map's own creation makes version 1.
CREATED = 1


@dataclass
class Write:
    """A keyframe that is sent until it is acknowledged."""

    map: str
    id: str
    # When it was sent first.
    sent: float
    # When the attempt was sent that was acknowledged.
    attempt: float = math.nan
    acknowledged: float = math.inf
    # The version that it made. A replay's answer does not name it.
    version: int | None = None
    # The map's version as a replay names it.
    replayed: int | None = None


@dataclass
class Read:
    map: str
    began: float
    ended: float
    version: int
    keyframes: int


@dataclass
class Stored:
    """A map as the database has it at the end."""

    version: int
    # The version that each keyframe made.
    keyframes: dict = field(default_factory=dict)
    # Keyframes whose content is not what was sent, each with what it is.
    other: dict = field(default_factory=dict)


def faults(writes, reads, stored):
    """Returns what is wrong: pairs of a kind and a sentence."""
    found = []
    for name, kept in stored.items():
        mine = [write for write in writes if write.map == name]
        found += of_content(name, mine, kept)
        found += of_versions(name, mine, kept)
        found += of_time(name, operations(mine, [read for read in reads if read.map == name], kept))
    found += [("torn read", f"{read.map}: {read.keyframes} keyframes at version {read.version}")
              for read in reads if read.keyframes != read.version - CREATED]
    return found


def of_content(name, writes, kept):
    for write in writes:
        if write.acknowledged < math.inf and write.id not in kept.keyframes:
            yield "lost write", f"{name}: {write.id} was acknowledged and is not there"
        elif write.id in kept.other:
            yield "other content", f"{name}: {write.id} is not what was sent: {kept.other[write.id]}"
    sent = {write.id for write in writes}
    for keyframe in kept.keyframes.keys() - sent:
        yield "other content", f"{name}: no writer sent {keyframe}"


def of_versions(name, writes, kept):
    makers = {}
    for write in writes:
        if write.version is None:
            continue
        first = makers.setdefault(write.version, write.id)
        if first != write.id:
            yield "version twice", f"{name}: version {write.version} was acknowledged for {first} and for {write.id}"
        if write.id in kept.keyframes and kept.keyframes[write.id] != write.version:
            yield "other version", f"{name}: {write.id} made {kept.keyframes[write.id]} and was told {write.version}"
    made = sorted(kept.keyframes.values())
    if made != list(range(CREATED + 1, kept.version + 1)):
        yield "not dense", f"{name}: {len(made)} keyframes, {len(set(made))} versions, the last {max(made, default=0)}; the map has {kept.version}"


def operations(writes, reads, kept):
    """Yields tuples (began, ended, version, is a write, its name)."""
    for write in writes:
        version = write.version or kept.keyframes.get(write.id)
        if version is not None:
            yield write.sent, write.acknowledged, version, True, write.id
        if write.replayed is not None:
            yield write.attempt, write.acknowledged, write.replayed, False, f"the replay of {write.id}"
            if version is not None and write.replayed < version:
                # Shown as a read that began after the write.
                yield math.inf, math.inf, write.replayed, False, f"the replay of {write.id}, which made {version}"
    for read in reads:
        yield read.began, read.ended, read.version, False, "a read"


def of_time(name, all_operations):
    begun = sorted(all_operations, key=lambda operation: operation[0])
    ended = sorted(begun, key=lambda operation: operation[1])
    newest, at = (0.0, 0.0, 0, False, "nothing"), 0
    for operation in begun:
        began, _, version, is_write, what = operation
        while ended[at][1] < began:
            newest = max(newest, ended[at], key=lambda other: (other[2], other[3]))
            at += 1
        if version < newest[2] or (is_write and version == newest[2]):
            kind = ("write" if is_write else "read") + " after " + ("write" if newest[3] else "read")
            yield kind, f"{name}: {what} has version {version}, and began {began - newest[1]:.6f} s after {newest[4]} ended with {newest[2]}"


def invented(draw, maps=3, length=400, wait=3.3):
    """Makes up a history without a fault: each operation takes effect at a moment between its two times, on average so long after the
    first and before the second. One takes effect each second."""
    writes, reads, stored = [], [], {}
    for number in range(maps):
        name, kept = f"m-{number}", Stored(CREATED)
        stored[name] = kept
        for moment in range(length):
            began, ended = moment - draw.expovariate(1 / wait), moment + draw.expovariate(1 / wait)
            if draw.random() < 0.5:
                reads.append(Read(name, began, ended, kept.version, kept.version - CREATED))
                continue
            kept.version += 1
            write = Write(name, f"kf-{moment}", began, began, ended, kept.version)
            kept.keyframes[write.id] = kept.version
            if draw.random() < 0.1:
                # Its first answer was lost.
                write.attempt, write.replayed, write.version = moment, kept.version, None
            writes.append(write)
    return writes, reads, stored


def apart(draw, writes):
    """Returns two acknowledged writes of a map of which one ended before the other began."""
    known = [write for write in writes if write.version is not None]
    while True:
        first, second = draw.sample(known, 2)
        if first.map == second.map and first.acknowledged < second.sent:
            return first, second


def lose(draw, writes, reads, stored):
    write = draw.choice(writes)
    del stored[write.map].keyframes[write.id]


def lose_last(draw, writes, reads, stored):
    """As a fail-over to a copy that is behind: the map's version is that of before, too."""
    kept = stored[writes[-1].map]
    del kept.keyframes[writes[-1].id]
    kept.version -= 1


def change(draw, writes, reads, stored):
    write = draw.choice(writes)
    stored[write.map].other[write.id] = "something else"


def repeat(draw, writes, reads, stored):
    first, second = apart(draw, writes)
    second.version = first.version


def swap(draw, writes, reads, stored):
    first, second = apart(draw, writes)
    kept = stored[first.map].keyframes
    first.version, second.version = second.version, first.version
    kept[first.id], kept[second.id] = first.version, second.version


def skip(draw, writes, reads, stored):
    stored[draw.choice(writes).map].version += 1


def read_stale(draw, writes, reads, stored):
    write = draw.choice([write for write in writes if write.version])
    reads.append(Read(write.map, write.acknowledged + 1e-6, write.acknowledged + 1, write.version - 1, write.version - 1 - CREATED))


def read_early(draw, writes, reads, stored):
    write = draw.choice([write for write in writes if write.version])
    reads.append(Read(write.map, write.sent - 1, write.sent - 1e-6, write.version, write.version - CREATED))


def read_back(draw, writes, reads, stored):
    """While a write is under way, one read returns it and a later one does not."""
    last = max(kept.version for kept in stored.values())
    name = next(name for name, kept in stored.items() if kept.version == last)
    stored[name].version += 1
    stored[name].keyframes["late"] = last + 1
    writes.append(Write(name, "late", 1e6, 1e6, 1e6 + 9, last + 1))
    reads.append(Read(name, 1e6 + 1, 1e6 + 2, last + 1, last + 1 - CREATED))
    reads.append(Read(name, 1e6 + 3, 1e6 + 4, last, last - CREATED))


def replay_stale(draw, writes, reads, stored):
    write = draw.choice([write for write in writes if write.replayed])
    write.replayed -= 1


def tear(draw, writes, reads, stored):
    draw.choice(reads).keyframes += 1


PLANTED = [
    (lose, "lost write"), (lose_last, "lost write"), (change, "other content"), (repeat, "version twice"), (swap, "write after"),
    (skip, "not dense"), (read_stale, "read after"), (read_early, "write after read"), (read_back, "read after read"),
    (replay_stale, "read after"), (tear, "torn read"),
]


def self_test(seeds=20):
    """Plants each fault in made-up histories. Returns how many were found, or raises AssertionError."""
    for seed in range(seeds):
        assert not faults(*invented(random.Random(seed))), f"seed {seed}: a fault where there is none"
        for plant, kind in PLANTED:
            draw = random.Random(seed)
            history = invented(draw)
            plant(draw, *history)
            kinds = {found for found, _ in faults(*history)}
            assert any(found.startswith(kind) for found in kinds), f"seed {seed}: {plant.__name__} is not found as {kind!r}: {kinds}"
    return seeds * len(PLANTED)
