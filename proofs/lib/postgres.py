#!/usr/bin/env python3
"""A PostgreSQL server of one's own, in a temporary folder.

    proofs/lib/postgres.py run COMMAND...

starts one, sets REVISIT_TEST_POSTGRES to its base URL for the command, and returns the command's exit code. Needs PostgreSQL's
programs (Debian: `postgresql`), and, as root, the user `postgres`: PostgreSQL refuses to run as root.
"""

import contextlib
import os
import pwd
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

USER = "postgres"
START_TIMEOUT_S = 60


def free_port():
    """Returns a port that nothing listens on, outside the range from which outgoing connections take theirs."""
    first, last = map(int, Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split())
    numbers = [number for number in range(10_000, 65_536) if not first <= number <= last] or range(first, last + 1)
    while True:
        port = random.SystemRandom().choice(numbers)
        with socket.socket() as probe:
            with contextlib.suppress(OSError):
                probe.bind(("127.0.0.1", port))
                return port


def programs():
    """Returns the folder of PostgreSQL's programs: PATH's, or Debian's of the newest version, which are not in PATH."""
    if found := shutil.which("initdb"):
        return Path(found).resolve().parent
    folders = [path.parent for path in Path("/usr/lib/postgresql").glob("*/bin/initdb")]
    if not folders:
        raise SystemExit("PostgreSQL's programs are missing (Debian: apt-get install postgresql)")
    return max(folders, key=lambda folder: float(folder.parent.name))


class Postgres:
    """One server; `url` is what the name of a database is appended to, after a slash."""

    def __init__(self, folder, is_durable, settings):
        self.folder, self.bin, self.port = Path(folder), programs(), free_port()
        self.data, self.log = self.folder / "data", self.folder / "log"
        self.url = f"postgres://{USER}@127.0.0.1:{self.port}"
        self.process = None
        # The folder is readable only to its owner, which has to be the user that PostgreSQL runs as.
        self.as_user = ["setpriv", "--pdeathsig", "QUIT"]
        if os.geteuid() == 0:
            user = pwd.getpwnam(USER)
            os.chown(self.folder, user.pw_uid, user.pw_gid)
            self.as_user += [f"--reuid={user.pw_uid}", f"--regid={user.pw_gid}", "--clear-groups"]
        initdb = [self.bin / "initdb", "-D", self.data, "-U", USER, "-A", "trust", "--locale=C.UTF-8", "-E", "UTF8", "--no-sync"]
        made = subprocess.run([*self.as_user, *initdb], cwd="/", capture_output=True, text=True)
        if made.returncode:
            raise SystemExit(f"initdb: {made.stdout}{made.stderr}")
        values = {"port": self.port, "listen_addresses": "127.0.0.1", "unix_socket_directories": "", "max_connections": 300}
        values |= {"fsync": "on" if is_durable else "off", "synchronous_commit": "on"} | settings
        with open(self.data / "postgresql.conf", "a") as configuration:
            configuration.writelines(f"{name} = '{value}'\n" for name, value in values.items())

    def start(self):
        """Starts it, and waits until it takes connections."""
        with open(self.log, "ab") as log:
            # In a session of its own: Ctrl-C is for the script, which stops PostgreSQL when its clients are gone.
            self.process = subprocess.Popen([*self.as_user, self.bin / "postgres", "-D", self.data], cwd="/", stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=log, start_new_session=True)
        ready = [self.bin / "pg_isready", "-q", "-h", "127.0.0.1", "-p", str(self.port)]
        end = time.monotonic() + START_TIMEOUT_S
        while subprocess.run(ready).returncode:
            if self.process.poll() is not None or time.monotonic() > end:
                raise SystemExit(f"PostgreSQL does not start: {self.log.read_text(errors='replace')[-2000:]}")
            time.sleep(0.05)

    def stop(self, how=signal.SIGINT):
        """Stops it: SIGINT rolls back what is open (fast), SIGQUIT lets everything lie as it is (immediate)."""
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(how)
            try:
                self.process.wait(timeout=60)
            except subprocess.TimeoutExpired:
                self.process.send_signal(signal.SIGQUIT)
                self.process.wait()
        self.process = None

    def ask(self, database, statement):
        """Returns the rows of a statement, each a list of texts."""
        command = [self.bin / "psql", "-X", "-q", "-A", "-t", "-F", "\t", "-v", "ON_ERROR_STOP=1", "-h", "127.0.0.1",
                   "-p", str(self.port), "-U", USER, "-d", database, "-c", statement]
        answer = subprocess.run(command, capture_output=True, text=True)
        if answer.returncode:
            raise AssertionError(f"{statement}: {answer.stderr}")
        return [line.split("\t") for line in answer.stdout.splitlines()]

    def create(self, database):
        """Makes a database, and returns its URL."""
        self.ask("postgres", f'create database "{database}"')
        return f"{self.url}/{database}"


@contextlib.contextmanager
def postgres(is_durable=True, **settings):
    """A PostgreSQL server that goes with the block, and all its data. One that is not durable (`fsync` off) is faster."""
    folder = tempfile.mkdtemp(prefix="revisit-postgres-")
    server = None
    try:
        server = Postgres(folder, is_durable, settings)
        server.start()
        yield server
    finally:
        if server is not None:
            server.stop()
        shutil.rmtree(folder, ignore_errors=True)


def end_on_sigterm():
    """Makes SIGTERM end the script as an exception does, so that what it started is stopped."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))


def main():
    if len(sys.argv) < 3 or sys.argv[1] != "run":
        raise SystemExit(__doc__)
    end_on_sigterm()
    # Tests make hundreds of databases, and lose nothing by a power failure.
    with postgres(is_durable=False) as server:
        command = subprocess.Popen(sys.argv[2:], env=os.environ | {"REVISIT_TEST_POSTGRES": server.url})
        try:
            code = command.wait()
        except KeyboardInterrupt:
            code = command.wait()
        finally:
            if command.poll() is None:
                command.terminate()
                command.wait()
    sys.exit(code if code >= 0 else 128 - code)


if __name__ == "__main__":
    main()
