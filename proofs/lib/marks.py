"""Marks: what one robot's requests carry and nothing else does, and where bytes still have it.

Whatever a client may send freely is drawn from marks: texts and names around a stem of letters, doubles with the same first five bytes,
point numbers and stamps from a range of their own, descriptors that begin with the same bytes. Robots that are to be erased have other
beginnings than those that stay, so one search for a beginning finds every mark of a kind, in whichever form a file or an answer holds it.

Not recognisable, and so not marked: weights of words (they are scaled), words and octaves (they are small), what a transformation
made of a number, and a point's number where it is stored as the distance to one that is not small.
"""

import base64
import functools
import os
import re
import struct
from pathlib import Path

LETTERS = "kqvwxz"
# Room for each robot, and for what a merge of sessions adds to its numbers: their beginning stays.
POINT_SPAN = 1 << 20
STAMP_SPAN = 200


def drawn_double(chance, low, high):
    """The first five bytes of doubles near a random one, and the digits that all of them begin with."""
    while True:
        head = struct.pack(">d", chance.uniform(low, high))[:5]
        ends = [repr(struct.unpack(">d", head + tail)[0]) for tail in (b"\0\0\1", b"\xff\xff\xff")]
        digits = os.path.commonprefix(ends)
        if len(digits.replace(".", "").lstrip("0")) >= 8 and 0 not in head:
            return head, digits


def varint(number):
    out = bytearray()
    while number >= 0x80:
        out.append(number & 0x7F | 0x80)
        number >>= 7
    out.append(number)
    return bytes(out)


def in_base64(stem):
    """What the base64 of any bytes holds that hold these, at each of the three places where they may begin."""
    for skipped in range(3):
        whole = base64.b64encode(bytes(skipped) + stem)
        first = -(-8 * skipped // 6)
        last = (skipped + len(stem)) * 8 // 6
        yield whole[first:last]


class Side:
    """The beginnings of the marks of some robots: of those that are to be erased, or of those that stay."""

    def __init__(self, chance, other=None):
        while True:
            self.stem = "".join(chance.choice(LETTERS) for _ in range(7))
            if other is None or self.stem[:4] != other.stem[:4]:
                break
        self.doubles = {"metres": drawn_double(chance, 4.1, 7.9), "pixels": drawn_double(chance, 260, 500),
                        # Three of them make a unit vector.
                        "unit": drawn_double(chance, 0.5772, 0.5775)}
        self.first_point = (chance.randrange(1 << 40, 1 << 41) << 21) | (1 << 19)
        self.first_second = chance.randrange(3 << 20, 6 << 20) * 32_000
        self.descriptor = bytes(chance.randrange(128, 256) for _ in range(7))
        self.owners = []

    def stems(self):
        """(kind, form, bytes, whether capitals are the same) of all that a mark begins with."""
        text = self.stem.encode()
        yield "text", "text", text, True
        yield "text", "UTF-16", self.stem.encode("utf-16-le"), True
        for form in in_base64(text):
            yield "text", "base64", form, False
        for name, (head, digits) in self.doubles.items():
            yield f"double ({name})", "big-endian", head, False
            yield f"double ({name})", "little-endian", head[::-1], False
            yield f"double ({name})", "decimal", digits.encode(), False
        point, second = self.first_point, self.first_second
        # Which five of the eight bytes begin them.
        for kind, number, span, first in (("point number", point, POINT_SPAN, 0), ("point block", point >> 6, POINT_SPAN >> 6, 1),
                                          ("stamp", second, STAMP_SPAN, 2)):
            head = number.to_bytes(8, "big")[first:first + 5]
            digits = os.path.commonprefix([str(number), str(number + span)])
            assert len(digits) >= 8, digits
            yield kind, "big-endian", head, False
            yield kind, "little-endian", head[::-1], False
            yield kind, "decimal", digits.encode(), False
        yield "point number", "zigzag varint", varint(2 * point)[4:], False
        yield "point number", "varint", varint(point)[3:], False
        yield "stamp", "zigzag varint", varint(2 * second)[2:], False
        yield "descriptor", "bytes", self.descriptor, False
        for form in in_base64(self.descriptor):
            yield "descriptor", "base64", form, False


class Owner:
    """Draws marks for one robot, and knows each that it gave away."""

    def __init__(self, side, name):
        self.side, self.name, self.given, self.count = side, name, {}, 0
        self.number = len(side.owners)
        assert self.number < 100
        # Two letters after the stem of its side tell the robot.
        self.stem = side.stem + chr(ord("a") + self.number // 10) + chr(ord("a") + self.number % 10)
        side.owners.append(self)

    def note(self, mark, what):
        self.given[mark] = what
        return mark

    def next(self):
        self.count += 1
        return self.count

    def text(self, what, before="", after=""):
        return self.note(f"{before}{self.stem}{self.next()}{after}", what)

    def word(self, what, before="", after=""):
        """A text without a number, which would make a name of it: the method asks no model about names."""
        letters = "".join(chr(ord("a") + int(digit)) for digit in str(self.next()))
        return self.note(f"{before}{self.stem}{letters}{after}", what)

    def double(self, kind, what):
        """A double whose last bytes tell whose it is, and which one."""
        tail = bytes([self.number + 1]) + (self.next() % (1 << 16)).to_bytes(2, "big")
        return self.note(struct.unpack(">d", self.side.doubles[kind][0] + tail)[0], what)

    metres = functools.partialmethod(double, "metres")
    pixels = functools.partialmethod(double, "pixels")
    unit = functools.partialmethod(double, "unit")

    def point(self, number):
        assert number < 1 << 12
        return self.note(self.side.first_point + (self.number << 12) + number, "a point's number")

    def second(self, number):
        assert number < STAMP_SPAN
        return self.note(self.side.first_second + number, "a stamp")

    def descriptors(self, count, each):
        out = bytearray()
        for _ in range(count):
            one = self.side.descriptor + bytes([self.number]) + self.next().to_bytes(2, "big")
            self.note(bytes(one), "a descriptor")
            out += (one * (each // len(one) + 1))[:each]
        return base64.b64encode(out).decode()


class Find:
    """A mark that was found."""

    def __init__(self, side, kind, form, place, data, at):
        self.side, self.kind, self.form, self.place = side, kind, form, place
        around = data[max(0, at - 24):at + 40]
        self.around = around.decode("latin-1") if all(32 <= byte < 127 for byte in around) else repr(bytes(around))
        self.mark = self.whole(form, data, at)
        # What tells it from other marks, to be looked for in single columns.
        self.bytes = data[at:at + 8]
        if form == "text":
            self.bytes = self.mark.encode()
        elif kind.startswith("double") and form == "little-endian":
            self.bytes = data[max(0, at - 3):at + 5]

    def tell(self):
        """Finds out whose it is, and what it was sent as."""
        told = {(owner.name, what) for owner in self.side.owners for what in [self.given(owner)] if what}
        self.owner = ", ".join(sorted({name for name, _ in told})) or "?"
        self.what = ", ".join(sorted({what for _, what in told})) or "?"
        return self

    def given(self, owner):
        """What the mark was sent as by this robot."""
        if isinstance(self.mark, str):
            whole = re.compile(rf"{self.mark}(?![a-z0-9])")
            return next((what for given, what in owner.given.items() if isinstance(given, str) and whole.search(given)), None)
        return owner.given.get(self.mark)

    def whole(self, form, data, at):
        """The mark as it was sent, where that can be told."""
        if form.endswith("hexadecimal"):
            first = max(at % 2, at - 16)
            digits = re.match(rb"([0-9a-f]{2})*", data[first:at + 64]).group()
            form = form.removesuffix(", hexadecimal")
            return self.whole(form, bytes.fromhex(digits.decode()), (at - first) // 2) if len(digits) > at - first else None
        if form == "text":
            return re.match(rb"[a-z]+[0-9]*", data[at:at + 40].lower()).group().decode()
        if form == "decimal":
            found = re.match(rb"[0-9.]+", data[at:at + 40]).group().decode().rstrip(".")
            return float(found) if "." in found else int(found)
        if self.kind.startswith("double"):
            order, first = ("<", at - 3) if form == "little-endian" else (">", at)
            return struct.unpack(f"{order}d", data[first:first + 8])[0] if 0 <= first <= len(data) - 8 else None
        return None

    def __str__(self):
        return f"{self.owner}: {self.kind} {self.mark} ({self.what}) as {self.form} in {self.place}\n      ... {self.around} ..."


class Hunt:
    """Looks for the marks of one side."""

    def __init__(self, side, as_hex=False):
        self.side, self.stems = side, []
        for kind, form, stem, folded in side.stems():
            self.stems.append((kind, form, stem.lower() if folded else stem, folded))
            if as_hex and form not in ("UTF-16", "decimal", "base64"):
                self.stems.append((kind, f"{form}, hexadecimal", stem.hex().encode(), True))
        self.places, self.bytes, self.most = set(), 0, 50

    def search(self, place, data):
        """What these bytes have of the marks: of each stem the first ones."""
        self.places.add(place)
        self.bytes += len(data)
        # The reserve beside a database.
        if len(data) > 1 << 20 and data == bytes(len(data)):
            return []
        folded, found = data.lower(), []
        for kind, form, stem, is_folded in self.stems:
            where, at = folded if is_folded else data, -1
            for _ in range(self.most):
                at = where.find(stem, at + 1)
                if at < 0:
                    break
                found.append(Find(self.side, kind, form, place, data, at))
        return found

    def search_folder(self, folder):
        found = []
        for path in sorted(Path(folder).rglob("*")):
            if path.is_file():
                found += self.search(f"file {path.relative_to(folder)}", path.read_bytes())
        return found
