"""From the log of a disk's operations to the files that a power failure would leave."""

import struct

WRITE, SYNC, OPEN, TRUNCATE, UNLINK = 1, 2, 4, 8, 16
HEADER = struct.Struct("<IIqQQ")
SECTOR = 512


def records(path):
    """(position of its end, operation, descriptor, result, offset, bytes) of each, in order."""
    with open(path, "rb") as log:
        while len(header := log.read(HEADER.size)) == HEADER.size:
            operation, fd, result, offset, length = HEADER.unpack(header)
            body = log.read(length) if operation in (WRITE, OPEN, UNLINK) else b""
            yield log.tell(), operation, fd, result, offset, body


class File:
    """What is on the disk for certain, and what the kernel still has to write."""

    def __init__(self):
        self.durable, self.pending = bytearray(), []

    def apply(self, onto, operation):
        kind, offset, body = operation
        if kind == TRUNCATE:
            del onto[offset:]
            onto.extend(bytes(offset - len(onto)))
            return
        if len(onto) < offset:
            onto.extend(bytes(offset - len(onto)))
        onto[offset:offset + len(body)] = body

    def synced(self):
        for operation in self.pending:
            self.apply(self.durable, operation)
        self.pending = []

    def after_a_crash(self, survives):
        image = bytearray(self.durable)
        for operation in self.pending:
            for part in survives(operation):
                self.apply(image, part)
        return image


class Disk:
    """The files as the log tells them, up to some position."""

    def __init__(self):
        self.names, self.files = {}, {}

    def take(self, record):
        _, operation, fd, result, offset, body = record
        if operation == OPEN:
            name = body.decode()
            self.names[fd] = name
            self.files.setdefault(name, File())
            return
        if operation == UNLINK:
            self.files.pop(body.decode(), None)
            return
        file = self.files.get(self.names.get(fd))
        if file is None:
            return
        if operation == WRITE:
            file.pending.append((WRITE, offset, body))
        elif operation == TRUNCATE:
            file.pending.append((TRUNCATE, offset, b""))
        elif operation == SYNC and result == 0:
            file.synced()
        elif operation == SYNC:
            # The kernel gives up what it could not write, and tells only once.
            file.pending = []


def nothing(operation):
    """All that was not synced is lost."""
    return []


def everything(operation):
    return [operation]


def some(chance):
    """Each write by itself reaches the disk, or does not."""
    return lambda operation: [operation] if chance.random() < 0.5 else []


def torn(chance):
    """Each sector by itself reaches the disk, or does not."""
    def sectors(operation):
        kind, offset, body = operation
        if kind != WRITE:
            return some(chance)(operation)
        starts = range(0, len(body), SECTOR)
        return [(WRITE, offset + at, body[at:at + SECTOR]) for at in starts if chance.random() < 0.5]
    return sectors
