"""PostgreSQL that fails over: members under Patroni, etcd, and HAProxy in front of them, in a temporary folder and on ports of its own.

Members replicate synchronously, and strictly so: with Patroni's defaults a fail-over may lose what was acknowledged. HAProxy leads to the
member whose Patroni answers `/primary` with 200, and ends the connections to one that no longer does.
"""

import contextlib
import http.client
import json
import os
import pwd
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from postgres import USER, free_port, programs

SCOPE = "revisit"
# Programs, and the Debian packages that have them.
NEEDED = {"patroni": "patroni", "patronictl": "patroni", "etcd": "etcd-server", "haproxy": "haproxy", "pgbouncer": "pgbouncer"}
# The least that newer versions of Patroni allow is a ttl of 20 s; loop_wait + 2 * retry_timeout may not exceed it.
TTL_S, LOOP_WAIT_S, RETRY_TIMEOUT_S = 20, 2, 5
START_TIMEOUT_S = 90
# The exit code where PostgreSQL did not fail over by itself, so that it may be tried once more.
NOT_SHOWN = 75
STOP_TIMEOUT_S = 20
PROBE_TIMEOUT_S = 2


def missing(*names):
    """Returns the packages of programs that are not here, after trying to install them as root. Their services stay off."""
    def absent():
        places = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
        return sorted({NEEDED[name] for name in names if not shutil.which(name, path=places)})

    if (packages := absent()) and os.geteuid() == 0 and shutil.which("apt-get"):
        command = ["apt-get", "install", "-qq", "-y", "--no-install-recommends", *packages]
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=os.environ | {"DEBIAN_FRONTEND": "noninteractive"})
        if Path("/run/systemd/system").exists():
            services = [package.removesuffix("-server") for package in packages]
            subprocess.run(["systemctl", "disable", "--now", *services], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return absent()


def program(name):
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def as_user(end_with):
    """Returns what begins a command: it runs as the user of PostgreSQL, and gets a signal when this script dies."""
    begin = ["setpriv", "--pdeathsig", end_with]
    if os.geteuid() == 0:
        user = pwd.getpwnam(USER)
        begin += [f"--reuid={user.pw_uid}", f"--regid={user.pw_gid}", "--clear-groups"]
    return begin


def start(command, log, end_with="KILL"):
    """Starts a program in a session of its own: Ctrl-C is for the script, which ends it when its clients are gone."""
    with open(log, "ab") as file:
        return subprocess.Popen([*as_user(end_with), *map(str, command)], cwd="/", stdin=subprocess.DEVNULL, stdout=file, stderr=file,
                                start_new_session=True)


def ask(port, database, statement, seconds=30):
    """Returns the rows of a statement, each a list of texts."""
    command = [programs() / "psql", "-X", "-q", "-A", "-t", "-F", "\t", "-v", "ON_ERROR_STOP=1", "-h", "127.0.0.1", "-p", str(port),
               "-U", USER, "-d", database, "-c", statement]
    environment = os.environ | {"PGCONNECT_TIMEOUT": str(seconds)}
    answer = subprocess.run(command, capture_output=True, text=True, timeout=seconds, env=environment)
    if answer.returncode:
        raise AssertionError(f"{statement}: {answer.stderr}")
    return [line.split("\t") for line in answer.stdout.splitlines()]


def children(pid):
    """Returns the processes that a process has started, by their numbers."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            # The name, in brackets, may hold anything; the parent comes second after it.
            if int(status.read_text().rpartition(")")[2].split()[1]) == pid:
                found.append(int(status.parent.name))
    return found


def send(pid, number):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)


class Member:
    """A PostgreSQL and the Patroni that starts, watches, promotes and demotes it."""

    def __init__(self, name, folder, etcd_port):
        self.name, self.folder = name, Path(folder) / name
        self.data, self.log = self.folder / "data", self.folder / "patroni.log"
        self.port, self.rest_port = free_port(), free_port()
        self.process = None
        self.folder.mkdir()
        # JSON is YAML.
        self.file = self.folder / "patroni.yml"
        self.file.write_text(json.dumps(self.configuration(etcd_port), indent=1))
        own(self.folder)

    def configuration(self, etcd_port):
        rest, address = f"127.0.0.1:{self.rest_port}", f"127.0.0.1:{self.port}"
        # Replicas that fall behind for a while, and former primaries, still find what they missed.
        parameters = {"max_connections": 100, "wal_keep_size": "256MB", "shared_buffers": "32MB"}
        return {
            "scope": SCOPE, "name": self.name,
            "restapi": {"listen": rest, "connect_address": rest},
            # Its second protocol: by the third one, Patroni 3.0.2 (Debian 12) sometimes names no synchronous standby any more after a
            # switchover, as it takes the key for one that somebody else changed.
            "etcd": {"host": f"127.0.0.1:{etcd_port}"},
            "bootstrap": {
                "dcs": {
                    "ttl": TTL_S, "loop_wait": LOOP_WAIT_S, "retry_timeout": RETRY_TIMEOUT_S,
                    "synchronous_mode": True, "synchronous_mode_strict": True,
                    "postgresql": {"use_pg_rewind": True, "use_slots": True, "parameters": parameters},
                },
                "initdb": [{"encoding": "UTF8"}, {"locale": "C.UTF-8"}, {"auth": "trust"}],
            },
            "postgresql": {
                "listen": address, "connect_address": address, "data_dir": str(self.data), "bin_dir": str(programs()),
                "pgpass": str(self.folder / "pgpass"),
                "authentication": {"superuser": {"username": USER}, "replication": {"username": "replicator"}},
                "pg_hba": ["host all all 127.0.0.1/32 trust", "host replication all 127.0.0.1/32 trust"],
                "parameters": {"unix_socket_directories": ""},
                "basebackup": {"checkpoint": "fast"},
            },
        }

    def start(self):
        # At SIGTERM it stops its PostgreSQL, too: also if the script dies.
        self.process = start([program("patroni"), self.file], self.log, "TERM")

    def postmaster(self):
        """Returns the process of its PostgreSQL, if there is one."""
        with contextlib.suppress(OSError, ValueError, IndexError):
            pid = int((self.data / "postmaster.pid").read_text().split()[0])
            if f"{self.data}" in Path(f"/proc/{pid}/cmdline").read_text():
                return pid
        return None

    def kill(self):
        """Kills PostgreSQL and Patroni at once, as a machine without power does."""
        postmaster = self.postmaster()
        everything = [] if postmaster is None else [postmaster, *children(postmaster)]
        if self.process is not None:
            self.process.send_signal(signal.SIGCONT)
            self.process.kill()
        for pid in everything:
            send(pid, signal.SIGKILL)
        if self.process is not None:
            self.process.wait()
        end = time.monotonic() + STOP_TIMEOUT_S
        while any(Path(f"/proc/{pid}").exists() for pid in everything) and time.monotonic() < end:
            time.sleep(0.02)
        self.process = None

    def pause(self):
        """Stops Patroni; its PostgreSQL runs on, and takes itself for the primary."""
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self):
        self.process.send_signal(signal.SIGCONT)

    def rest(self, path, timeout=1.0):
        """Returns the status and the text of Patroni's answer; 0 if there is none."""
        connection = http.client.HTTPConnection("127.0.0.1", self.rest_port, timeout=timeout)
        try:
            connection.request("GET", path)
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        except (OSError, http.client.HTTPException):
            return 0, ""
        finally:
            connection.close()

    def is_primary(self):
        return self.rest("/primary")[0] == 200


class Watch(threading.Thread):
    """Notes when a member answers `/primary` with 200, and when no longer."""

    EVERY_S = 0.1

    def __init__(self, member):
        super().__init__(daemon=True)
        self.member, self.is_primary, self.is_over = member, False, False
        # Moments at which it became the primary.
        self.since = []

    def run(self):
        while not self.is_over:
            is_primary = self.member.is_primary()
            if is_primary and not self.is_primary:
                self.since.append(time.monotonic())
            self.is_primary = is_primary
            time.sleep(self.EVERY_S)


def own(folder):
    """Gives a folder to the user of PostgreSQL, who has to be its owner."""
    if os.geteuid() == 0:
        user = pwd.getpwnam(USER)
        for path in [folder, *Path(folder).rglob("*")]:
            os.chown(path, user.pw_uid, user.pw_gid)


class Proxy:
    """HAProxy, which leads to the primary."""

    def __init__(self, folder, members):
        self.folder, self.port, self.process = Path(folder), free_port(), None
        # A primary that is no more may still run: a connection to it would be of the past.
        servers = [f"  server {member.name} 127.0.0.1:{member.port} check port {member.rest_port}" for member in members]
        self.file = self.folder / "haproxy.cfg"
        self.file.write_text("\n".join([
            "global", "  maxconn 500",
            "defaults", "  mode tcp", "  timeout connect 2s", "  timeout check 2s", "  timeout client 30m", "  timeout server 30m",
            "listen primary", f"  bind 127.0.0.1:{self.port}", "  option httpchk GET /primary", "  http-check expect status 200",
            "  default-server inter 1s fall 2 rise 1 on-marked-down shutdown-sessions", *servers, ""]))
        own(self.file.parent)

    def start(self):
        self.process = start([program("haproxy"), "-f", self.file, "-db"], self.folder / "haproxy.log")

    def restart(self):
        self.kill()
        self.start()

    @contextlib.contextmanager
    def reloaded(self):
        """Has a new process take the port over, as a reload does. The former one serves the connections that it has, checks no member
        any more, and ends with the block."""
        former = self.process
        self.process = start([program("haproxy"), "-f", self.file, "-db", "-sf", former.pid], self.folder / "haproxy.log")
        try:
            yield
        finally:
            former.kill()
            former.wait()

    def kill(self):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
        self.process = None


class FailingOver:
    """The members, their etcd, and the proxy; `port` leads to the primary."""

    def __init__(self, folder, count):
        self.folder = Path(folder)
        own(self.folder)
        self.etcd_port, peer = free_port(), f"http://127.0.0.1:{free_port()}"
        here = f"http://127.0.0.1:{self.etcd_port}"
        self.etcd_command = [
            program("etcd"), "--enable-v2", "--name", "etcd", "--data-dir", self.folder / "etcd", "--listen-client-urls", here,
            "--advertise-client-urls", here, "--listen-peer-urls", peer, "--initial-advertise-peer-urls", peer,
            "--initial-cluster", f"etcd={peer}"]
        self.etcd = None
        self.members = [Member(f"member-{number}", self.folder, self.etcd_port) for number in range(count)]
        self.proxy = Proxy(self.folder, self.members)
        self.port = self.proxy.port
        self.watches = [Watch(member) for member in self.members]

    def start(self):
        self.etcd = start(self.etcd_command, self.folder / "etcd.log")
        # The first one makes the database, which the others then copy.
        for member in self.members:
            member.start()
            self.expect(lambda: self.primary() is not None, "a primary")
        self.proxy.start()
        self.expect(self.is_whole, "replicas, one of them synchronous")
        self.ask("create table probe (written int)", "postgres")
        for watch in self.watches:
            watch.start()

    def expect(self, condition, what, seconds=START_TIMEOUT_S):
        """Waits for something that Patroni and PostgreSQL must do by themselves. If they do not, the script ends with 75: of Revisit
        nothing was shown."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                print(f"FAILED: no {what} in {seconds} s\n{self.cluster_view()}\n{self.state()}", flush=True)
                sys.exit(NOT_SHOWN)
            time.sleep(0.2)

    def primary(self):
        """Returns the member that is the primary, as Patroni says."""
        return next((member for member in self.members if member.is_primary()), None)

    def roles(self):
        """Returns the role and the state of each member, as the primary has them."""
        primary = self.primary()
        if primary is None:
            return {}
        status, text = primary.rest("/cluster")
        if status != 200:
            return {}
        return {member["name"]: (member["role"], member.get("state")) for member in json.loads(text)["members"]}

    def is_whole(self):
        """Whether every member runs, and one of them is the synchronous standby."""
        roles = self.roles()
        fine = all(state in ("running", "streaming") for _, state in roles.values())
        return fine and sorted(role for role, _ in roles.values()).count("sync_standby") == 1 and len(roles) == len(self.members)

    def became_primary(self, since, other_than):
        """Returns when another member than one answered as the primary first, after a moment; None if none has yet."""
        watches = [watch for watch in self.watches if watch.member is not other_than]
        return min((moment for watch in watches for moment in watch.since if moment > since), default=None)

    def switch_over(self):
        """Has Patroni make the synchronous standby the primary."""
        command = [program("patronictl"), "-c", self.members[0].file, "switchover", SCOPE, "--force"]
        done = subprocess.run([*as_user("KILL"), *map(str, command)], cwd="/", capture_output=True, text=True, timeout=60,
                              env=os.environ | {"LC_ALL": "C.UTF-8"})
        if done.returncode or "Switchover failed" in done.stdout:
            raise AssertionError(f"patronictl: {done.stdout}{done.stderr}")

    def ask(self, statement, database=SCOPE):
        return ask(self.port, database, statement)

    def takes_writes(self):
        """Whether a write of no server of ours is committed: what Patroni, PostgreSQL and HAProxy make possible by themselves."""
        try:
            ask(self.port, "postgres", "insert into probe values (1)", PROBE_TIMEOUT_S)
            return True
        except (AssertionError, subprocess.TimeoutExpired):
            return False

    def cluster_view(self):
        """Returns what the primary says of all members."""
        primary = self.primary()
        return primary and primary.rest("/cluster")

    def state(self):
        """Returns what the members say, to be printed with a failure."""
        told = [f"{member.name}: {member.rest('/patroni')}" for member in self.members]
        logs = [f"{member.log}:\n{member.log.read_text(errors='replace')[-1500:]}" for member in self.members if member.log.exists()]
        return "\n".join([*told, *logs])

    def stop(self):
        for watch in self.watches:
            watch.is_over = True
        self.proxy.kill()
        for member in self.members:
            member.kill()
        if self.etcd is not None:
            self.etcd.kill()
            self.etcd.wait()


@contextlib.contextmanager
def failing_over(count):
    """A PostgreSQL that fails over, which goes with the block, and all its data."""
    folder = tempfile.mkdtemp(prefix="revisit-failover-")
    database = None
    try:
        database = FailingOver(folder, count)
        database.start()
        yield database
    finally:
        if database is not None:
            database.stop()
        shutil.rmtree(folder, ignore_errors=True)
