"""A server of its own for a proof: started on a temporary database, asked over plain sockets, stopped at the end."""

import http.client
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def binary():
    """The binary named by REVISIT, or one that is built now."""
    if "REVISIT" in os.environ:
        return os.environ["REVISIT"]
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(target / "release" / "revisit")


class Server:
    """`with Server(program) as server:` has it listen on `server.host`, `server.port`."""

    def __init__(self, program, *flags):
        self.folder = tempfile.TemporaryDirectory()
        database = f"sqlite://{self.folder.name}/proof.db"
        command = [program, "serve", "--listen", "127.0.0.1:0", "--log", "error", "--database", database, *flags]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        address = self.process.stdout.readline().strip().removeprefix("listening on http://")
        self.host, port = address.rsplit(":", 1)
        self.port = int(port)
        self.pid = self.process.pid

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.code = self.process.wait(timeout=30)
        self.folder.cleanup()

    def ask(self, method, path, body=None, **headers):
        """One request on a connection of its own: the status and the body of its answer."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=120)
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body, sent)
        answer = connection.getresponse()
        result = answer.status, answer.read()
        connection.close()
        return result
