"""Where a database's bytes are: SQLite's files and copies of them, or a dump of PostgreSQL's tables."""

import os
import sqlite3
import struct
import subprocess
import tempfile
from pathlib import Path

from server import expect


class OnSqlite:
    name, is_hexadecimal = "sqlite", False
    # Where the search finds marks of what stays.
    shows = ["file revisit.db", "the command backup", "a backup by POST", "the command export"]

    def __init__(self, folder, _):
        self.folder = folder / "data"
        self.folder.mkdir()
        self.file = self.folder / "revisit.db"
        self.url = f"sqlite://{self.file}"

    def search(self, hunt):
        return hunt.search_folder(self.folder)

    def search_copies(self, hunt, round):
        """New backups, of the server's and of the command's, and the command's exports."""
        found, of_server = [], round.folder / "backups"
        taken = expect(round.ask("POST", "/v1/backups", {})).json()["id"]
        for path in of_server.rglob("*"):
            if path.is_file() and taken in str(path.relative_to(of_server)):
                found += hunt.search("a backup by POST", path.read_bytes())
        with tempfile.TemporaryDirectory(dir=round.folder) as name:
            file = Path(name) / "copy"
            for command in ["backup"], *(["export", of.name] for of in round.every_map):
                subprocess.run([round.program, *command, file, "--database", self.url], check=True, capture_output=True, timeout=60)
                found += hunt.search(f"the command {command[0]}", file.read_bytes())
                file.unlink()
        return found

    def where(self, marks):
        """The columns that hold one of these, for the report."""
        database = sqlite3.connect(f"file:{self.file}?mode=ro", uri=True)
        database.text_factory = bytes
        held = set()
        for (table,) in database.execute("select name from sqlite_schema where type = 'table'").fetchall():
            rows = database.execute(f"select * from {table.decode()}")
            columns = [column[0] for column in rows.description]
            for row in rows:
                for column, value in zip(columns, row):
                    if isinstance(value, int):
                        value = value.to_bytes(8, "big", signed=True)
                    value = struct.pack(">d", value) if isinstance(value, float) else value
                    if isinstance(value, bytes) and any(mark in value or mark in value.lower() for mark in marks):
                        held.add(f"{table.decode()}.{column}")
        database.close()
        return sorted(held)


class OnPostgres:
    """PostgreSQL has tools of its own for backups."""

    name, is_hexadecimal = "postgres", True
    shows = ["table public.keyframes", "table public.sessions"]

    def __init__(self, _, seed):
        base, name = os.environ["REVISIT_TEST_POSTGRES"], f"erasure_{os.getpid()}_{seed}"
        subprocess.run(["psql", "-q", f"{base}/postgres", "-c", f"create database {name}"], check=True)
        self.url = f"{base}/{name}"

    def search(self, hunt):
        """All tables as text; bytes are hexadecimal there."""
        dump = subprocess.run(["pg_dump", "--data-only", self.url], capture_output=True, check=True).stdout
        found = []
        for part in dump.split(b"\nCOPY ")[1:]:
            found += hunt.search(f"table {part.split(b' ', 1)[0].decode()}", part)
        return found

    def search_copies(self, *_):
        return []

    def where(self, _):
        return []


STORES = {store.name: store for store in (OnSqlite, OnPostgres)}
