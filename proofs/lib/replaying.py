"""Recordings played against a server, through a proxy that keeps each answer."""

import http.server
import subprocess
import threading

from server import Client

FORWARDED = ("authorization", "if-match", "content-type")


def proxy(address, answers):
    """Listens on a port of its own, forwards each request and notes its answer."""

    class Forward(http.server.BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"
        disable_nagle_algorithm = True
        wbufsize = -1

        def setup(self):
            super().setup()
            self.behind = Client(address, timeout=300)

        def forward(self):
            length = int(self.headers.get("content-length", 0))
            raw = self.rfile.read(length) if length else None
            headers = {name: self.headers[name] for name in FORWARDED if name in self.headers}
            answer = self.behind.ask(self.command, self.path, headers=headers, raw=raw,
                                     kind=headers.get("content-type", "application/json"))
            answers.append((self.command, self.path, answer.status, answer.body))
            self.send_response(answer.status)
            for name, value in answer.headers.items():
                if name.lower() in ("content-type", "retry-after", "idempotent-replayed", "etag"):
                    self.send_header(name, value)
            self.send_header("content-length", str(len(answer.body)))
            self.end_headers()
            self.wfile.write(answer.body)

        do_GET = do_PUT = do_POST = do_PATCH = do_DELETE = forward

        def log_message(self, *_):
            pass

    listening = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Forward)
    threading.Thread(target=listening.serve_forever, daemon=True).start()
    return listening


def replayed(program, recording, server):
    """Plays a recording against a server; returns each request with its answer: method, path, status, body."""
    answers = []
    listening = proxy(server.address, answers)
    url = f"http://127.0.0.1:{listening.server_port}"
    subprocess.run([program, "replay", str(recording), "--json", "--server", url],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    listening.shutdown()
    return answers


def is_verdict(answer):
    _, path, _, _ = answer
    return "loop-queries" in path or "query=loop" in path


def differing(before, after):
    """The pairs of answers that differ: those of verdicts, and the others. The requests must be the same."""
    if [answer[:2] for answer in before] != [answer[:2] for answer in after]:
        raise AssertionError("other requests were made")
    changed = [(a, b) for a, b in zip(before, after) if a != b]
    return [pair for pair in changed if is_verdict(pair[0])], [pair for pair in changed if not is_verdict(pair[0])]


def show(pairs):
    for (method, path, status, body), (_, _, now, other) in pairs[:3]:
        at = next((n for n, pair in enumerate(zip(body, other)) if pair[0] != pair[1]), min(len(body), len(other)))
        print(f"  {method} {path}: {status} ...{body[max(0, at - 60):at + 60]!r}\n    now {now} ...{other[max(0, at - 60):at + 60]!r}")
