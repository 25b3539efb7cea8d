"""A second opinion on histories: stateright's search over every order of operations, on parts of a history that are short enough.

`linearizable.py` trusts the versions that answers name, and judges a whole history in one pass. The search knows only that each write makes the
next version. A part begins and ends at moments when no operation on its map was under way. Where there is none for long, as while a server is
stopped, it is the operations of some successive versions: what such a part says of their order has to hold, and the order of two parts is
judged by `linearizable.py` only.
"""

import os
import random
import shutil
import subprocess
from pathlib import Path

from linearizable import PLANTED, CREATED, faults, invented, operations

# Operations of one part: the search takes time that grows exponentially with those under way at once.
PART_MAX = 24
# At most so many operations are cut into one part where there is a choice.
PART = 8
MODEL = Path(__file__).parents[1] / "lease-model"
# Of made-up histories: operations overlap, and there are moments at which none is under way.
WAIT = 0.4
# Faults that are of time, not of what is stored.
OF_TIME = ("swap", "read_stale", "read_early", "read_back", "replay_stale", "repeat")


def parts(name, of_map):
    """Returns the parts of a map's history as lines, and how many operations are in none."""
    lines, left_out, part, before, until, newest = [], 0, [], CREATED, float("-inf"), CREATED
    for operation in sorted(of_map):
        if operation[0] > until and len(part) >= PART:
            left_out += written(lines, name, before, part)
            part, before = [], newest
        part.append(operation)
        until, newest = max(until, operation[1]), max(newest, operation[2])
    left_out += written(lines, name, before, part)
    return lines, left_out


def written(lines, name, before, part):
    """Adds the lines of a part, or of smaller ones by version, and returns how many operations are in none."""
    if len(part) <= PART_MAX:
        lines.append(f"window {name} {before}")
        lines += [f"{'w' if is_write else 'r'} {began!r} {ended!r} {version}" for began, ended, version, is_write, _ in part]
        return 0
    of_version = {}
    for operation in part:
        of_version.setdefault(operation[2], []).append(operation)
    left_out, smaller = 0, []
    for version, its_operations in sorted(of_version.items()):
        if smaller and len(smaller) + len(its_operations) > PART_MAX:
            left_out, smaller = left_out + written(lines, name, before, smaller), []
        if len(its_operations) > PART_MAX:
            left_out += len(its_operations)
            continue
        if not smaller:
            # Before its write, if it is among them.
            before = version - any(is_write for *_, is_write, _ in its_operations)
        smaller += its_operations
    return left_out + (written(lines, name, before, smaller) if smaller else 0)


def second_opinion(writes, reads, stored, folder):
    """Returns what the search says, whether it found a fault, and how many operations it was not asked about; None without a Rust
    toolchain."""
    if shutil.which("cargo") is None:
        return None
    lines, left_out = [], 0
    for name, kept in stored.items():
        of_map = operations([write for write in writes if write.map == name], [read for read in reads if read.map == name], kept)
        its_lines, its_left_out = parts(name, of_map)
        lines, left_out = lines + its_lines, left_out + its_left_out
    path = Path(folder) / "windows"
    path.write_text("".join(f"{line}\n" for line in lines))
    env = {"CARGO_TARGET_DIR": str(Path(__file__).parents[2] / "target"), **os.environ}
    run = ["cargo", "run", "--release", "--locked", "--quiet", "--bin", "histories", "--", str(path)]
    done = subprocess.run(run, cwd=MODEL, env=env, capture_output=True, text=True)
    if done.returncode not in (0, 1) or not done.stdout:
        raise RuntimeError(f"the search did not run: {done.stderr}")
    return done.stdout.strip(), done.returncode == 1, left_out


def self_test(folder, seeds=5):
    """Plants each fault of time in made-up histories: both must find it. Returns how many; None without a Rust toolchain."""
    found = 0
    for seed in range(seeds):
        history = invented(random.Random(seed), wait=WAIT)
        said = second_opinion(*history, folder)
        if said is None:
            return None
        assert not said[1] and said[2] == 0, f"seed {seed}: {said}"
        for plant, _ in PLANTED:
            if plant.__name__ not in OF_TIME:
                continue
            draw = random.Random(seed)
            history = invented(draw, wait=WAIT)
            plant(draw, *history)
            assert faults(*history), (seed, plant.__name__)
            assert second_opinion(*history, folder)[1], f"seed {seed}: {plant.__name__} is not found by the search"
            found += 1
    return found
