"""Hosts: network namespaces, each with an address of its own, joined by a bridge, whose network can be cut.

A script that uses them runs in a network namespace of its own, so that nothing of the machine's network is touched, and nothing is left behind.
Needs root, and `ip`, `unshare` and `nsenter` (Debian: iproute2, util-linux).
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

MARK = "REVISIT_PROOF_NETWORK"
# The script's own address, and the beginning of those of the hosts.
GATEWAY, NET, BRIDGE = "10.77.0.1", "10.77.0.", "hosts"
STARTS_S = 10


def is_entered():
    """Whether this script has a network namespace of its own."""
    return os.environ.get(MARK) == str(os.getpid())


def enter():
    """Runs this script anew in a network namespace of its own. Returns why it cannot, or not at all."""
    if os.geteuid() != 0:
        return "only root can make network namespaces"
    if missing := [name for name in ("ip", "unshare", "nsenter") if shutil.which(name) is None]:
        return f"{', '.join(missing)} missing"
    tried = subprocess.run(["unshare", "--net", "--", "ip", "link", "add", BRIDGE, "type", "bridge"], capture_output=True, text=True)
    if tried.returncode:
        return f"this machine does not let us: {tried.stderr.strip()}"
    sys.stdout.flush()
    # The process stays the same one.
    os.environ[MARK] = str(os.getpid())
    os.execvp("unshare", ["unshare", "--net", "--", sys.executable, *sys.argv])


def ip(*words):
    subprocess.run(["ip", *map(str, words)], check=True)


def bridge():
    """Joins the script and its hosts."""
    ip("link", "set", "lo", "up")
    ip("link", "add", BRIDGE, "type", "bridge")
    ip("address", "add", f"{GATEWAY}/24", "dev", BRIDGE)
    ip("link", "set", BRIDGE, "up")


class Host:
    """A host, which goes with the script."""

    def __init__(self, number):
        self.address, self.cable = f"{NET}{10 + number}", f"cable{number}"
        # Its namespace is there as long as this process, which reads to the end of a pipe.
        self.holder = subprocess.Popen(["unshare", "--net", "--", "cat"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
        space = Path(f"/proc/{self.holder.pid}/ns/net")
        end = time.monotonic() + STARTS_S
        while os.readlink(space) == os.readlink("/proc/self/ns/net"):
            if time.monotonic() > end:
                raise SystemExit(f"host {number} got no network namespace")
            time.sleep(0.01)
        # What a command begins with to run there.
        self.wrap = ["nsenter", f"--net={space}", "--"]
        ip("link", "add", self.cable, "type", "veth", "peer", "name", "eth0", "netns", self.holder.pid)
        ip("link", "set", self.cable, "master", BRIDGE, "up")
        self.ip("address", "add", f"{self.address}/24", "dev", "eth0")
        self.ip("link", "set", "lo", "up")
        self.ip("link", "set", "eth0", "up")

    def ip(self, *words):
        subprocess.run([*self.wrap, "ip", *map(str, words)], check=True)

    def unplug(self):
        """Nothing reaches it any more, nor leaves it; no connection is told."""
        ip("link", "set", self.cable, "down")

    def plug(self):
        ip("link", "set", self.cable, "up")

    def part_from(self, others):
        """What it sends to these hosts fails at once; they hear nothing from it."""
        for other in others:
            self.ip("route", "add", "blackhole", f"{other.address}/32")

    def join(self, others):
        for other in others:
            self.ip("route", "del", "blackhole", f"{other.address}/32")
