"""A network between a server and its database that can be cut: a TCP relay."""

import contextlib
import socket
import threading

CHUNK = 1 << 16


class Relay:
    """Relays connections to a port of this machine until it is cut. `address` is where it listens, at `host`.

    Ways to cut it: `silent` carries nothing any more, `deaf` carries requests but no answers, and `closed` ends all connections and
    begins none. What is sent during the first two arrives late, when the relay is restored, unless its sender closed the connection
    and the receiver no longer reads: as TCP does it after an interruption that is shorter than its timeouts.
    """

    def __init__(self, port, host="127.0.0.1"):
        self.to = "127.0.0.1", port
        self.lock, self.pairs = threading.Lock(), set()
        self.is_closed, self.requests, self.answers = False, threading.Event(), threading.Event()
        self.restore()
        self.listener = socket.create_server((host, 0), backlog=64)
        self.address = "{}:{}".format(*self.listener.getsockname())
        threading.Thread(target=self.accept, daemon=True).start()

    def cut(self, how):
        if how == "closed":
            with self.lock:
                self.is_closed = True
                pairs = list(self.pairs)
            for pair in pairs:
                self.end(pair)
        else:
            self.answers.clear()
            if how == "silent":
                self.requests.clear()

    def restore(self):
        with self.lock:
            self.is_closed = False
        self.requests.set()
        self.answers.set()

    def ports(self):
        """Returns the ports of its ends at the database, by which the database tells connections apart."""
        with self.lock:
            return [database.getsockname()[1] for _, database in self.pairs]

    def accept(self):
        while True:
            client, _ = self.listener.accept()
            with self.lock:
                is_closed = self.is_closed
            try:
                if is_closed:
                    raise OSError("cut")
                database = socket.create_connection(self.to)
            except OSError:
                client.close()
                continue
            pair = client, database
            for end in pair:
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            with self.lock:
                self.pairs.add(pair)
            threading.Thread(target=self.carry, args=(pair, client, database, self.requests), daemon=True).start()
            threading.Thread(target=self.carry, args=(pair, database, client, self.answers), daemon=True).start()

    def carry(self, pair, source, sink, gate):
        with contextlib.suppress(OSError):
            while chunk := source.recv(CHUNK):
                gate.wait()
                sink.sendall(chunk)
            # Also its end arrives late.
            gate.wait()
        self.end(pair)

    def end(self, pair):
        with self.lock:
            self.pairs.discard(pair)
        for end in pair:
            # Wakes the thread that reads from it; a close alone does not.
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()
