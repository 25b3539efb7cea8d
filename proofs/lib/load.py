"""Load on a server, and what it costs: many clients at once in one thread, each of which sends its next request when its last one is
answered; and the server's CPU."""

import os
import pathlib
import selectors
import socket
import time


TICKS = os.sysconf("SC_CLK_TCK")


def cpu_s(server):
    """CPU that a server has used so far, user and system, in seconds."""
    fields = pathlib.Path(f"/proc/{server.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


class _Client:
    def __init__(self, host, port):
        self.socket = socket.create_connection((host, port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.received, self.began = b"", 0.0

    def send(self, host, method, path, body):
        head = f"{method} {path} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\ncontent-length: {len(body)}\r\n\r\n"
        self.received, self.began = b"", time.monotonic()
        self.socket.sendall(head.encode() + body)

    def status(self):
        """Takes what has arrived; the status once the answer is whole."""
        self.received += self.socket.recv(1 << 18)
        head, found, rest = self.received.partition(b"\r\n\r\n")
        if not found:
            return None
        lines = head.lower().split(b"\r\n")
        length = next(int(line.split(b":")[1]) for line in lines if line.startswith(b"content-length:"))
        return int(lines[0].split()[1]) if len(rest) >= length else None


def ask_at_once(address, clients, requests):
    """Sends all requests (method, path, body); the time of each answer in milliseconds, the seconds that all took, and the
    statuses that are neither 200 nor 201."""
    host, port = address.rsplit(":", 1)
    waiting, times, others = iter(requests), [], []
    with selectors.DefaultSelector() as answers:
        for client, request in zip((_Client(host, int(port)) for _ in range(clients)), waiting):
            client.send(address, *request)
            answers.register(client.socket, selectors.EVENT_READ, client)
        began = time.monotonic()
        while answers.get_map():
            for key, _ in answers.select():
                client = key.data
                status = client.status()
                if status is None:
                    continue
                times.append(1e3 * (time.monotonic() - client.began))
                if status not in (200, 201):
                    others.append(status)
                request = next(waiting, None)
                if request is None:
                    answers.unregister(client.socket)
                    client.socket.close()
                else:
                    client.send(address, *request)
        return times, time.monotonic() - began, others
