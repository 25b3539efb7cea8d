"""A stand-in for a model. It repeats what it was asked in its reasons, so that marks come back from it, and can be made to hold its answers."""

import http.server
import json
import threading
import time
import zlib

# It does not hold an answer for longer.
HELD_S = 60


class Models(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Answers)
        self.free = threading.Event()
        self.free.set()
        # Answers that are still given while others are held.
        self.allowed = self.asked = self.holding = 0
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def hold(self, after=0):
        """From now on holds its answers, after so many."""
        self.allowed = after
        self.free.clear()

    def settled(self, seconds=4):
        """Waits until nothing has been asked for a while."""
        until, asked, since = time.monotonic() + seconds, self.asked, time.monotonic()
        while time.monotonic() < min(until, since + 0.7):
            if asked != self.asked:
                asked, since = self.asked, time.monotonic()
            time.sleep(0.05)

    def flags(self, name):
        url = f"http://127.0.0.1:{self.server_address[1]}/v1"
        return ["--model-url", url, "--model-name", name, "--model-retry-delay-ms", "1", "--model-breaker-pause-ms", "20",
                "--model-text-timeout-ms", "20000", "--model-calls-at-once", "1"]

    def handle_error(self, request, client_address):
        """A server that was killed does not wait for its answer."""


class Answers(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    # Else each answer takes 40 ms: its body waits until its head is acknowledged.
    disable_nagle_algorithm = True

    def log_message(self, *_):
        pass

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["content-length"])))
        models = self.server
        models.asked += 1
        if models.allowed > 0:
            models.allowed -= 1
        else:
            models.holding += 1
            models.free.wait(HELD_S)
            models.holding -= 1
        said = json.dumps({"choices": [{"index": 0, "finish_reason": "stop", "message": {"role": "assistant", "content": self.answer(body)}}],
                           "usage": {"prompt_tokens": 100, "completion_tokens": 10, "total_tokens": 110}}).encode()
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(said)))
        self.end_headers()
        self.wfile.write(said)

    @staticmethod
    def answer(body):
        user = body["messages"][-1]["content"]
        text = user if isinstance(user, str) else user[0].get("text", "")
        schema = body.get("response_format", {}).get("json_schema", {}).get("name")
        if schema == "level":
            level = 4 if '"a"' not in text else 2 + zlib.crc32(f"{body['model']} {text}".encode()) % 4
            return json.dumps({"reason": f"it was asked: {text[:300]}", "level": level})
        if schema == "text":
            return json.dumps({"text": f"both of {text[:200]}"})
        return "a boat on a wall"
