"""A server of one's own: finds the program, starts it on a free port, and stops it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import deque
from pathlib import Path
from types import TracebackType

from .problems import RevisitError

START_LINE = "listening on "
STOP_PATIENCE_S = 10.0


class ServerNotFound(RevisitError):
    """No `revisit` program on this machine."""


def find_binary() -> str:
    """Return the path of the `revisit` program: $REVISIT_BINARY, beside this Python, or on PATH."""
    named = os.environ.get("REVISIT_BINARY")
    if named:
        if not os.access(named, os.X_OK):
            raise ServerNotFound(f"$REVISIT_BINARY names {named}, which is no program")
        return named
    beside = Path(sys.executable).parent / "revisit"
    if os.access(beside, os.X_OK):
        return str(beside)
    found = shutil.which("revisit")
    if found is None:
        raise ServerNotFound(
            "no `revisit` program: name it in $REVISIT_BINARY (cargo build --release makes target/release/revisit), "
            "or pass --server URL of a running server"
        )
    return found


class Server:
    """A server on a free port of this machine (`listen` names another). Without `database` its data are thrown away when it stops."""

    def __init__(self, database: Path | None = None, *arguments: str, listen: str = "127.0.0.1:0") -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="revisit-")
        folder = Path(self._folder.name)
        self._log = (folder / "server.log").open("w+b")
        command = [
            find_binary(), "serve", "--listen", listen, "--database", f"sqlite://{database or folder / 'revisit.db'}", *arguments
        ]
        # Settings of another server in the environment are none of this one's.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("REVISIT_")}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._log, env=environment)
        assert self._process.stdout is not None
        first = self._process.stdout.readline().decode().strip()
        if not first.startswith(START_LINE):
            self._process.wait()
            self._log.seek(0)
            why = self._log.read().decode(errors="replace").strip().splitlines()
            self._folder.cleanup()
            raise RevisitError(f"the server did not start: {(why or [first or 'it said nothing'])[-1]}")
        self.url = first.removeprefix(START_LINE)
        # What it prints later must not fill the pipe.
        threading.Thread(target=deque, args=(self._process.stdout, 0), daemon=True).start()

    def stop(self) -> None:
        """Stop the server; what is in flight is finished first."""
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(STOP_PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._log.close()
        self._folder.cleanup()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.stop()
