"""Many clients at once in one thread: each sends its next request when its last one is answered."""

import json
import selectors
import socket
import time


class _Client:
    def __init__(self, host, port):
        self.socket = socket.create_connection((host, port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.received, self.began = b"", 0.0

    def send(self, host, path, body):
        text = json.dumps(body).encode()
        head = f"POST {path} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\ncontent-length: {len(text)}\r\n\r\n"
        self.received, self.began = b"", time.monotonic()
        self.socket.sendall(head.encode() + text)

    def status(self):
        """Takes what has arrived; the status once the answer is whole."""
        self.received += self.socket.recv(1 << 18)
        head, found, rest = self.received.partition(b"\r\n\r\n")
        if not found:
            return None
        lines = head.lower().split(b"\r\n")
        length = next(int(line.split(b":")[1]) for line in lines if line.startswith(b"content-length:"))
        return int(lines[0].split()[1]) if len(rest) >= length else None


def ask_at_once(address, clients, path, bodies):
    """Asks all `bodies`; the time of each answer in milliseconds, the seconds that all took, and the statuses but 200."""
    host, port = address.rsplit(":", 1)
    waiting, times, others = iter(bodies), [], []
    with selectors.DefaultSelector() as answers:
        for client, body in zip((_Client(host, int(port)) for _ in range(clients)), waiting):
            client.send(address, path, body)
            answers.register(client.socket, selectors.EVENT_READ, client)
        began = time.monotonic()
        while answers.get_map():
            for key, _ in answers.select():
                client = key.data
                status = client.status()
                if status is None:
                    continue
                times.append(1e3 * (time.monotonic() - client.began))
                if status != 200:
                    others.append(status)
                body = next(waiting, None)
                if body is None:
                    answers.unregister(client.socket)
                    client.socket.close()
                else:
                    client.send(address, path, body)
        return times, time.monotonic() - began, others
