"""Robots with marks of their own, the keyframes that they send, and what is in a map as they know it."""

import base64
import copy
import struct
import zlib

IDENTITY = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
# Half a turn about x, which leaves the marked coordinate as it is.
HALF_TURN = {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}
SHARED_POINTS, WORDS, OWN_POINTS = 60, 40, 600
PICTURES = ["a painting of a small red boat on a stormy sea by", "a portrait of a lady with a mysterious smile by",
            "a picture of a red sailing ship in a storm by", "the famous portrait of the lady who smiles by"]
SIGNS = ["901", "902", "903", "904", "905", "EXIT", "Ausgang"]


def at(x, y=0.0, z=0.0, rotation=IDENTITY):
    return {"translation": {"x": x, "y": y, "z": z}, "rotation": rotation}


def png(mark, colour):
    """A picture that says the mark in a comment."""
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))  # noqa: E731
    row = b"\0" + bytes([colour, 90, 200]) * 60
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 60, 40, 8, 2, 0, 0, 0)) + chunk(b"tEXt", b"Comment\0" + mark.encode())
            + chunk(b"IDAT", zlib.compress(row * 40)) + chunk(b"IEND", b""))


class Map:
    """What is in a map as its clients know it."""

    def __init__(self, name):
        self.name = name
        # Of each keyframe its robot; of each session the one that it is a part of; loops' names; of each release what is in it.
        self.keyframes, self.merged, self.loops, self.releases = {}, {}, set(), {}
        # The session whose merge can still be revoked.
        self.undo, self.published_meanwhile = None, 0

    @property
    def path(self):
        return f"/v1/maps/{self.name}"

    def whole(self, session):
        while session in self.merged:
            session = self.merged[session]
        return session

    def copied(self, name):
        other = copy.copy(self)
        other.name, other.releases, other.undo = name, {}, None
        other.keyframes, other.merged, other.loops = dict(self.keyframes), dict(self.merged), set(self.loops)
        return other

    def of(self, robot):
        return [name for name, whose in self.keyframes.items() if whose is robot]


class Robot:
    """One robot of a map. A group is a part of another robot's session, erased by its keyframes."""

    def __init__(self, owner, chance, doomed, session_of=None):
        self.owner, self.chance, self.doomed, self.is_group = owner, chance, doomed, session_of is not None
        self.session = session_of.session if session_of else owner.text("a session's name", after="-run")
        self.number, self.culled = 0, []

    def placed(self, what, ids, y):
        """These points with marked positions."""
        return {"ids": ids, "positions": [[self.owner.metres(what), y, 2.0] for _ in ids]}

    def painting(self, picture, x=1.0):
        """What a model is asked about."""
        return {"class": "painting", "confidence": 0.9, "box": [100.0, 100.0, 160.0, 140.0], "position": [x, 0.0, 2.0],
                "description": self.owner.word("a description", PICTURES[picture] + " ")}

    def detection(self, y, points):
        chance, owner = self.chance, self.owner
        body = {"class": "door_number" if chance.random() < 0.7 else owner.text("a class", "sign "),
                "confidence": owner.unit("a confidence"), "box": [100.0, 100.0, owner.pixels("a box"), 540.5]}
        kind = chance.random()
        if kind < 0.4:
            body["text"] = chance.choice(SIGNS)
        elif kind < 0.7:
            body["text"] = chance.choice([owner.text, owner.word])("a text", f"room {chance.randrange(700, 790)} ")
        else:
            body["class"] = "painting" if chance.random() < 0.5 else body["class"]
            body["description"] = owner.word("a description", chance.choice(PICTURES) + " ")
        if chance.random() < 0.6:
            body["position"] = [owner.metres("a detection's position"), y, 2.0]
        if chance.random() < 0.5:
            body["map_points"] = chance.sample(points, 3)
        if chance.random() < 0.3:
            body["crop"] = base64.b64encode(png(owner.text("a crop"), chance.randrange(256))).decode()
        return body

    def body(self, of):
        """A keyframe. Of points that all robots have it brings positions, unless only its keyframes are erased: such a point is its session's."""
        chance, owner, number = self.chance, self.owner, self.number
        y = number * 0.5
        shared = chance.sample(range(SHARED_POINTS), 14)
        own = [owner.point((number * 3 + i) % OWN_POINTS) for i in range(5)]
        seen = shared + own
        turned = {axis: owner.unit("a rotation") for axis in "xyz"} | {"w": 0.0}
        body = {
            "session": of.whole(self.session),
            "stamp": {"sec": owner.second(number % 200), "nanosec": chance.randrange(10**9)},
            "pose": at(owner.metres("a pose"), y, 1.0, turned if chance.random() < 0.4 else IDENTITY),
            "map_points": self.placed("a point's position", own if self.is_group else seen, y),
            "observes": seen,
            "bow": {"words": (words := chance.sample(range(WORDS), 20)), "weights": [1.0 + chance.random() for _ in words]},
            "detections": [self.detection(y, seen) for _ in range(chance.randrange(4))],
        }
        if chance.random() < 0.7:
            body["camera"] = {"fx": owner.pixels("a camera"), "fy": 525.0, "cx": owner.pixels("a camera"), "cy": 240.0, "width": 640, "height": 480}
        if chance.random() < 0.4:
            body["gravity"] = [owner.unit("gravity") for _ in range(3)]
        if chance.random() < 0.4:
            body["global_descriptor"] = {"model": "net-1", "encoding": "int8", "data": owner.descriptors(1, 32)}
        if chance.random() < 0.5:
            matched = chance.sample(seen, 6)
            body["features"] = {"descriptor_bytes": 32, "descriptors": owner.descriptors(8, 32),
                                "keypoints": [[owner.pixels("a keypoint"), 40.0 + i, i % 4] for i in range(8)], "map_points": matched + [-1, -1]}
        return body

    def new_name(self):
        self.number += 1
        return self.owner.text("a keyframe's id", after=f"-{self.number}")

    def new(self, of):
        """A keyframe's name and itself."""
        body = self.body(of)
        return self.new_name(), body
