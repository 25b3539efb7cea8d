"""Where the memory of a server is, and how much data it has: what tells a leak from data that grows, and where a leak lies.

`/proc/PID/smaps` by kind of mapping. The allocator of Rust (mimalloc) reserves arenas of a gigabyte; glibc, from which SQLite's C code
takes its memory, has the heap after the program, an arena of 64 MiB a thread, and mappings of their own for what is large. `huge` counts
within the others: pages of 2 MiB, of which a part may never have been used.
"""

import json
import sqlite3
import threading
import time
from pathlib import Path

ARENA = 64 << 20
RESERVED = 256 << 20
STACK = 2 << 20
KINDS = ("rust", "glibc", "stacks", "other", "program", "files")
# What the server says of itself.
FIGURES = ("map_memory_bytes", "index_bytes", "feature_cache_bytes", "maps", "keyframes", "anchors", "connections_open", "open_fds",
           "database_bytes", "wal_bytes", "map_loads", "followed_maps")
MIB = 1 << 20


class Mapping:
    def __init__(self, head):
        span, self.mode, _, _, _, *name = head.split(maxsplit=5)
        self.begin, self.end = (int(at, 16) for at in span.split("-"))
        self.name = name[0].strip() if name else ""
        self.kib = {}

    def kind(self):
        if self.name.startswith("/"):
            # What the linker made of the program's data counts with it.
            return "program" if "(deleted)" in self.name or not self.name.endswith("-shm") else "files"
        if self.name == "[heap]":
            return "glibc"
        if self.name:
            return "stacks" if self.name == "[stack]" else "other"
        if self.end - self.begin >= RESERVED:
            return "rust"
        if self.begin % ARENA == 0 and self.end - self.begin <= ARENA:
            return "glibc"
        return "stacks" if self.end - self.begin == STACK else "other"


def mappings(pid):
    """Returns the mappings of a process."""
    found = []
    with open(f"/proc/{pid}/smaps") as lines:
        for line in lines:
            name, _, rest = line.partition(":")
            if " " in name:
                found.append(Mapping(line))
            elif rest.endswith("kB\n"):
                found[-1].kib[name] = int(rest.split()[0])
    return found


def memory(pid):
    """Returns what a process has in memory, in KiB by kind; its huge pages; and its threads."""
    kib = dict.fromkeys(KINDS, 0)
    huge = 0
    for mapping in mappings(pid):
        kib[mapping.kind()] += mapping.kib["Rss"]
        huge += mapping.kib.get("AnonHugePages", 0)
    return kib | {"huge": huge, "threads": sum(1 for _ in Path(f"/proc/{pid}/task").iterdir())}


def rolled_up(pid):
    """Returns the resident memory of a process and the anonymous part of it, in KiB, as exact as the kernel knows it."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()[1:]
    kib = {name: int(rest.split()[0]) for name, _, rest in (line.partition(":") for line in lines)}
    return kib["Rss"], kib["Anonymous"]


def figures(client):
    """Returns what the server says of its caches and maps."""
    told = {}
    for line in client.ask("GET", "/metrics").body.decode().splitlines():
        name, _, value = line.partition(" ")
        if name.removeprefix("revisit_") in FIGURES:
            told[name.removeprefix("revisit_")] = float(value)
    return told


def rows_of_sqlite(path):
    """Returns the number of rows of each table."""
    database = sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=10)
    try:
        tables = [row[0] for row in database.execute("select name from sqlite_master where type = 'table' and name not like 'sqlite_%'")]
        return {table: database.execute(f'select count(*) from "{table}"').fetchone()[0] for table in tables}
    finally:
        database.close()


def rows_of_postgres(postgres, name):
    """Returns the number of rows of each table."""
    tables = [row[0] for row in postgres.ask(name, "select tablename from pg_tables where schemaname = current_schema()")]
    counts = " union all ".join(f"select '{table}', count(*) from \"{table}\"" for table in tables)
    return {table: int(count) for table, count in postgres.ask(name, counts)}


class Watch(threading.Thread):
    """Notes the memory of a server: its sum often, its parts and the data now and then."""

    SUM_S, PARTS_S = 2.0, 30.0

    def __init__(self, server, count_rows, path=None):
        super().__init__(daemon=True)
        self.server, self.client, self.count_rows = server, server.client(), count_rows
        self.began, self.path = time.monotonic(), path
        self.sums, self.parts, self.trouble = [], [], None
        self.stopping = threading.Event()

    def run(self):
        parts_due = 0.0
        try:
            while not self.stopping.wait(self.SUM_S):
                at = time.monotonic() - self.began
                self.sums.append((at, *rolled_up(self.server.process.pid)))
                self.write({"at": at, "rss": self.sums[-1][1], "anonymous": self.sums[-1][2]})
                if at >= parts_due:
                    parts_due = at + self.PARTS_S
                    self.parts.append(
                        {"at": at} | memory(self.server.process.pid) | figures(self.client) | {"rows": self.count_rows()})
                    self.write(self.parts[-1])
        except Exception as trouble:  # such as that the server has ended
            self.trouble = trouble

    def write(self, sample):
        if self.path:
            with open(self.path, "a") as lines:
                lines.write(json.dumps(sample) + "\n")


def told(parts):
    """Returns a line about one sample of the parts."""
    kinds = ", ".join(f"{kind} {parts[kind] / 1024:.1f}" for kind in KINDS)
    return (f"{kinds} MiB (huge {parts['huge'] / 1024:.1f}), {parts['threads']} threads; features {parts['feature_cache_bytes'] / MIB:.1f}, "
            f"maps {parts['map_memory_bytes'] / MIB:.1f} MiB in {parts['maps']:.0f}; database {parts['database_bytes'] / MIB:.1f} MiB, "
            f"{sum(parts['rows'].values())} rows")
