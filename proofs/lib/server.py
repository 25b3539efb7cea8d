"""The real server as a process, and the few words needed to speak to it."""

import atexit
import contextlib
import http.client
import json
import os
import signal
import subprocess
import sqlite3
import shutil
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
START_TIMEOUT_S = 60
KEY = os.environ.get("REVISIT_KEY")


def binary():
    """The program to prove: REVISIT, or a release build of this tree."""
    if "REVISIT" in os.environ:
        return os.environ["REVISIT"]
    command = ["cargo", "build", "--release", "--locked", "--message-format=json-render-diagnostics"]
    built = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
    messages = (json.loads(line) for line in built.stdout.splitlines())
    programs = [m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "revisit"]
    return programs[-1]


def shim(folder):
    """Builds the library that stands between the server and its disk."""
    library = Path(folder) / "disk.so"
    source = Path(__file__).with_name("disk.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", library, source, "-ldl"], check=True)
    return library


class Gone(Exception):
    """The server does not answer any more."""


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)

    def __repr__(self):
        return f"{self.status} {self.body[:400]!r}"


def expect(answer, *statuses):
    """The answer, if it has one of these statuses; of none, any that says it was done."""
    if answer.status not in (statuses or (200, 201, 204)):
        raise AssertionError(f"{answer} instead of {statuses or 'success'}")
    return answer


class Client:
    """One connection of one thread, opened again when the server may have closed it as idle (`--keep-alive`, 75 s)."""

    IDLE_S = 30

    def __init__(self, address, timeout=60):
        self.address, self.timeout = address, timeout
        self.connection, self.used_at = None, 0.0

    def ask(self, method, path, body=None, headers=(), raw=None, kind="application/json"):
        send = dict(headers)
        if KEY:
            send["authorization"] = f"Bearer {KEY}"
        if body is not None:
            raw = json.dumps(body).encode()
        if raw is not None:
            send["content-type"] = kind
        try:
            if time.monotonic() - self.used_at > self.IDLE_S:
                self.close()
            if self.connection is None:
                host, port = self.address.rsplit(":", 1)
                self.connection = http.client.HTTPConnection(host, int(port), timeout=self.timeout)
            self.connection.request(method, path, raw, send)
            response = self.connection.getresponse()
            answer = Answer(response.status, response.headers, response.read())
            self.used_at = time.monotonic()
            return answer
        except (OSError, http.client.HTTPException) as error:
            self.close()
            raise Gone(f"{method} {path}: {error!r}") from error

    def close(self):
        if self.connection is not None:
            self.connection.close()
        self.connection = None


class Server:
    """`revisit serve` on a database that outlives it: a file, or a URL, which needs `log`."""

    def __init__(self, program, database, *more, env=None, log=None, wrap=(), wait=True, listen="127.0.0.1:0"):
        self.database = Path(database)
        url = database if "://" in str(database) else f"sqlite://{database}"
        self.log = Path(log or f"{database}.log")
        environment = {k: v for k, v in os.environ.items() if not k.startswith("REVISIT_")} | (env or {})
        command = [*wrap, program, "serve", "--listen", listen, "--database", url, *more]
        with open(self.log, "ab") as log_file:
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=log_file, env=environment, text=True)
        # Whatever becomes of the script, it leaves no server behind.
        atexit.register(self.abandon)
        self.address = None
        if wait:
            line = self.process.stdout.readline()
            if "listening on http://" not in line:
                self.process.wait()
                raise Gone(f"the server said {line!r} and ended with {self.process.returncode}: {self.last_words()}")
            self.address = line.split("http://")[1].strip()

    def client(self, timeout=60):
        return Client(self.address, timeout)

    def last_words(self):
        return self.log.read_text(errors="replace")[-2000:] if self.log.exists() else ""

    def alive(self):
        return self.process.poll() is None

    def rss_kib(self):
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
        return 0

    @contextlib.contextmanager
    def paused(self):
        """Stops every thread of the server for as long as the block takes. The signal alone is not enough: until the
        kernel has stopped the last thread, one may still checkpoint and write on, and a copy of the files be torn."""
        os.kill(self.process.pid, signal.SIGSTOP)
        os.waitpid(self.process.pid, os.WUNTRACED)
        try:
            yield
        finally:
            os.kill(self.process.pid, signal.SIGCONT)

    def kill(self):
        """SIGKILL; one that is dead already died of itself."""
        if not self.alive():
            raise AssertionError(f"the server ended of itself: {self.process.returncode}: {self.last_words()}")
        self.process.kill()
        self.process.wait()
        atexit.unregister(self.abandon)

    def stop(self):
        """SIGTERM; it must end well."""
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(timeout=60)
        if code != 0:
            raise AssertionError(f"the server ended with {code}: {self.last_words()}")
        atexit.unregister(self.abandon)

    def abandon(self):
        if self.alive():
            self.process.kill()
        self.process.wait()


@contextlib.contextmanager
def passing(program, *more):
    """A server on a database that goes with it."""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(program, Path(folder) / "revisit.db", "--log", "error", *more)
        try:
            yield server
            server.stop()
        finally:
            server.abandon()


def integrity(database):
    """What SQLite finds wrong with a copy of the files as they are; opening them would mend them before the server can."""
    copy = Path(f"{database}.copy")
    for suffix in ("", "-wal", "-shm"):
        Path(f"{copy}{suffix}").unlink(missing_ok=True)
    for suffix in ("", "-wal"):
        if Path(f"{database}{suffix}").exists():
            shutil.copyfile(f"{database}{suffix}", f"{copy}{suffix}")
    try:
        connection = sqlite3.connect(copy)
        try:
            faults = [row[0] for row in connection.execute("pragma integrity_check")]
            dangling = list(connection.execute("pragma foreign_key_check"))
        finally:
            connection.close()
    except sqlite3.DatabaseError as error:
        return [str(error)]
    finally:
        for suffix in ("", "-wal", "-shm"):
            Path(f"{copy}{suffix}").unlink(missing_ok=True)
    return [fault for fault in faults if fault != "ok"] + [f"dangling: {row}" for row in dangling]


def expect_integrity(database, when):
    faults = integrity(database)
    if faults:
        fail(f"integrity_check {when}: {faults[:3]}")


def fail(text):
    print(f"FAILED: {text}", flush=True)
    sys.exit(1)


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(len(ordered) * share))] if ordered else float("nan")


def until(condition, seconds, what):
    """Waits for something that must come."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    fail(f"{what} did not happen in {seconds} s")
