"""Marks: what one robot's requests carry and nothing else does, and where bytes still have it.

Whatever a client may send freely is drawn from its owner's marks: texts and names around a stem of letters, doubles whose first five
bytes are the owner's, point numbers and stamps from a range of its own, descriptors that begin with the same bytes. So one search
for the beginning finds every mark of a kind, in whichever form a file or an answer may hold it.

Not recognisable, and so not marked: weights of words (they are scaled), words and octaves (they are small), what a transformation
made of a number, and a point's number where it is stored as the distance to one that is not small.
"""

import base64
import os
import re
import struct
from pathlib import Path

LETTERS = "kqvwxz"
# Two octets to spare, so that numbers may be shifted by what a merge of sessions adds to them, and their beginning stays.
POINT_SPAN = 1 << 20
STAMP_SPAN = 200
TEXT, BYTES = "text", "bytes"


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


class Owner:
    """Draws marks for one robot, and knows each that it gave away."""

    def __init__(self, chance, name, taken=()):
        self.chance, self.name, self.given, self.count = chance, name, {}, 0
        while True:
            self.stem = "".join(chance.choice(LETTERS) for _ in range(7))
            if all(self.stem[:4] != other[:4] for other in taken):
                break
        self.doubles = {"metres": drawn_double(chance, 4.1, 7.9), "pixels": drawn_double(chance, 260, 500),
                        # Three of them make a unit vector.
                        "unit": drawn_double(chance, 0.5772, 0.5775)}
        self.first_point = (chance.randrange(1 << 40, 1 << 41) << 21) | (1 << 19)
        self.first_second = chance.randrange(3 << 20, 6 << 20) * 32_000
        self.descriptor = bytes(chance.randrange(128, 256) for _ in range(7))

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
        number = self.next()
        letters = "".join(chr(ord("a") + int(digit)) for digit in str(number))
        return self.note(f"{before}{self.stem}{letters}{after}", what)

    def double(self, kind, what):
        """A double whose last bytes tell which one it is."""
        tail = (self.next() * 257 + 1) % (1 << 24)
        return self.note(struct.unpack(">d", self.doubles[kind][0] + tail.to_bytes(3, "big"))[0], what)

    def metres(self, what):
        return self.double("metres", what)

    def pixels(self, what):
        return self.double("pixels", what)

    def unit(self, what):
        return self.double("unit", what)

    def point(self, number):
        assert number < 1 << 12
        return self.note(self.first_point + number, "a point's number")

    def second(self, number):
        assert number < STAMP_SPAN
        return self.note(self.first_second + number, "a stamp")

    def descriptors(self, count, each):
        out = bytearray()
        for _ in range(count):
            one = self.descriptor + self.next().to_bytes(3, "big")
            self.note(bytes(one), "a descriptor")
            out += (one * (each // len(one) + 1))[:each]
        return base64.b64encode(out).decode()

    def stems(self):
        """(kind, form, bytes, whether capitals are the same) of all that a mark begins with."""
        text = self.stem.encode()
        yield TEXT, "text", text, True
        yield TEXT, "UTF-16", self.stem.encode("utf-16-le"), True
        for form in in_base64(text):
            yield TEXT, "base64", form, False
        for name, (head, digits) in self.doubles.items():
            yield f"double ({name})", "big-endian", head, False
            yield f"double ({name})", "little-endian", head[::-1], False
            yield f"double ({name})", "decimal", digits.encode(), False
        point = self.first_point
        yield "point number", "little-endian", point.to_bytes(8, "little")[3:], False
        yield "point number", "big-endian", point.to_bytes(8, "big")[:5], False
        yield "point number", "decimal", self.digits(point, point + POINT_SPAN), False
        yield "point number", "zigzag varint", varint(2 * point)[4:], False
        yield "point number", "varint", varint(point)[3:], False
        block = point >> 6
        yield "point block", "big-endian", block.to_bytes(8, "big")[1:6], False
        yield "point block", "little-endian", block.to_bytes(8, "little")[2:7], False
        yield "point block", "decimal", self.digits(block, block + (POINT_SPAN >> 6)), False
        second = self.first_second
        yield "stamp", "big-endian", second.to_bytes(6, "big")[:5], False
        yield "stamp", "little-endian", second.to_bytes(8, "little")[1:6], False
        yield "stamp", "decimal", self.digits(second, second + STAMP_SPAN), False
        yield "stamp", "zigzag varint", varint(2 * second)[2:], False
        yield "descriptor", "bytes", self.descriptor, False
        for form in in_base64(self.descriptor):
            yield "descriptor", "base64", form, False

    @staticmethod
    def digits(low, high):
        shared = os.path.commonprefix([str(low), str(high)])
        assert len(shared) >= 8, shared
        return shared.encode()


class Find:
    def __init__(self, owner, kind, form, place, data, at):
        self.owner, self.kind, self.form, self.place = owner, kind, form, place
        around = data[max(0, at - 24):at + 40]
        self.around = around.decode("latin-1") if all(32 <= byte < 127 for byte in around) else repr(bytes(around))
        self.mark, self.what = self.whole(data, at)

    def whole(self, data, at):
        """The mark as it was sent, and what it was sent as, where that can be told."""
        owner = self.owner
        if self.form.endswith("hexadecimal"):
            form, self.form = self.form, self.form.removesuffix(", hexadecimal")
            first = max(at % 2, at - 16)
            near = data[first:at + 64]
            digits = re.match(rb"([0-9a-f]{2})*", near).group()
            told = self.whole(bytes.fromhex(digits.decode()), (at - first) // 2) if len(digits) > at - first else (owner.stem, "?")
            self.form = form
            return told
        if self.form == "text":
            found = re.match(rb"[a-z]*\d*", data[at:at + 40].lower())
            mark = found.group().decode() if found else owner.stem
            told = sorted({what for given, what in owner.given.items() if isinstance(given, str) and re.search(rf"{mark}(?![a-z0-9])", given)})
            return mark, ", ".join(told) or "?"
        if self.kind.startswith("double") and self.form != "decimal":
            if self.form == "little-endian":
                mark = struct.unpack("<d", data[at - 3:at + 5])[0] if at >= 3 else None
            else:
                mark = struct.unpack(">d", data[at:at + 8])[0] if at + 8 <= len(data) else None
            return mark, owner.given.get(mark, "?")
        if self.form == "decimal":
            found = re.match(rb"[\d.]+", data[at:at + 40]).group().decode()
            number = float(found) if "." in found else int(found)
            return found, owner.given.get(number, "?")
        return owner.stem, "?"

    def __str__(self):
        return (f"{self.owner.name}: {self.kind} {self.mark} ({self.what}) as {self.form} in {self.place}\n"
                f"      ... {self.around} ...")


class Hunt:
    """Looks for the marks of some owners."""

    def __init__(self, owners, as_hex=False):
        self.stems = []
        for owner in owners:
            for kind, form, stem, folded in owner.stems():
                self.stems.append((owner, kind, form, stem.lower() if folded else stem, folded))
                if as_hex and form not in ("text", "UTF-16", "decimal", "base64"):
                    self.stems.append((owner, kind, f"{form}, hexadecimal", stem.hex().encode(), True))
                elif as_hex and form == "text":
                    self.stems.append((owner, kind, "text, hexadecimal", stem.hex().encode(), True))
        self.places, self.bytes = set(), 0

    def search(self, place, data, most=3):
        """What these bytes have of the marks: of each stem the first few."""
        self.places.add(place)
        self.bytes += len(data)
        # The reserve beside a database.
        if len(data) > 1 << 20 and data == bytes(len(data)):
            return []
        folded, found = data.lower(), []
        for owner, kind, form, stem, is_folded in self.stems:
            where, at = folded if is_folded else data, -1
            for _ in range(most):
                at = where.find(stem, at + 1)
                if at < 0:
                    break
                found.append(Find(owner, kind, form, place, data, at))
        return found

    def search_folder(self, folder, but=()):
        found = []
        for path in sorted(Path(folder).rglob("*")):
            if path.is_file() and path.name not in but:
                found += self.search(f"file {path.relative_to(folder)}", path.read_bytes())
        return found
