"""Bag: a ROS 2 recording (MCAP or SQLite), or a ROS 1 bag: pictures, their camera, and odometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ...errors import RevisitError
from ..camera import Calibration
from ..frames import Frame, plain_id
from ..trajectory import Trajectory
from .needed import needed
from .source import ROTATIONS, Source, posed, too_near
from .transforms import StaticTransforms
from .video import save

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
MODELS = ("plumb_bob", "rational_polynomial", "equidistant", "fisheye", "")
FISHEYE = ("equidistant", "fisheye")
ODOMETRY = "nav_msgs/msg/Odometry"
TF_STATIC = "tf2_msgs/msg/TFMessage"
# Each encoding's conversion to BGR.
ENCODINGS = {
    "bgr8": None,
    "rgb8": cv2.COLOR_RGB2BGR,
    "bgra8": cv2.COLOR_BGRA2BGR,
    "rgba8": cv2.COLOR_RGBA2BGR,
    "mono8": cv2.COLOR_GRAY2BGR,
    "8UC1": cv2.COLOR_GRAY2BGR,
    "8UC3": None,
}
# Names of topics whose pictures are depths.
DEPTH_WORDS = ("depth", "disparity")
MAX_TOLD = 12


@dataclass(frozen=True)
class Topics:
    """Topics that a person named; None: the one that there is."""

    image: str | None = None
    camera_info: str | None = None
    odometry: str | None = None


def open_bag(
    file: Path, topics: Topics, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, work: Path
) -> Source:
    """Open a recording; its pictures are kept in `work`. A trajectory given is the camera's."""
    if not file.exists():
        raise RevisitError(f"{file}: no such file")
    highlevel, typesys = needed("rosbags.highlevel", "rosbags"), needed("rosbags.typesys", "rosbags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    try:
        # Recordings carry their messages' definitions, or have the standard ones.
        with highlevel.AnyReader([file], default_typestore=store) as reader:
            return _Bag(file, reader, topics).source(calibration, trajectory, every_s, work)
    except RevisitError:
        raise
    except Exception as error:  # It raises types of its own, and whatever a damaged file leads to.
        raise RevisitError(f"{file}: rosbags cannot read it: {(str(error) or type(error).__name__).splitlines()[0]}") from error


class _Bag:
    def __init__(self, file: Path, reader: Any, topics: Topics) -> None:
        self._file, self._reader, self._topics = file, reader, topics

    def source(self, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, work: Path) -> Source:
        topic = self._one("image", self._topics.image, (IMAGE, COMPRESSED), skip=DEPTH_WORDS)
        if topic is None:
            raise RevisitError(f"{self._file}: no pictures in it ({IMAGE}, {COMPRESSED}); it has {self._told()}")
        first = next(self._messages(topic), None)
        if first is None:
            raise RevisitError(f"{self._file}: no picture on {topic}")
        camera_frame = first[1].header.frame_id
        calibration = calibration or self._calibration(topic, camera_frame)
        frames = self._frames(topic, calibration, every_s, work)
        notes = () if calibration is not None else (f"no {CAMERA_INFO} for {topic}: a common focal length is assumed",)
        poses = ROTATIONS
        if trajectory is not None:
            poses = f"those of {trajectory.name}"
        else:
            trajectory, why = self._odometry(camera_frame)
            notes += why
            if trajectory is not None:
                poses = f"odometry on {trajectory.name.rpartition(' ')[2]}"
        if trajectory is not None:
            frames, left_out = posed(frames, trajectory)
            notes += left_out
        return Source(frames, str(self._file), poses, notes=notes)

    def _messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        """Yield the messages of a topic with their times in nanoseconds, in order of recording."""
        connections = [connection for connection in self._reader.connections if connection.topic == topic]
        for connection, logged_ns, data in self._reader.messages(connections):
            message = self._reader.deserialize(data, connection.msgtype)
            header = getattr(message, "header", None)
            stamp_ns = header.stamp.sec * 1_000_000_000 + header.stamp.nanosec if header is not None else 0
            # A stamp that nobody set: the time of its recording.
            yield stamp_ns or logged_ns, message

    def _one(self, option: str, named: str | None, types: tuple[str, ...], skip: tuple[str, ...] = ()) -> str | None:
        """Return the topic that was named, or the only one of these types."""
        there = sorted({c.topic for c in self._reader.connections if c.msgtype in types})
        if named is not None:
            if named not in there:
                raise RevisitError(f"--{option}-topic {named}: {self._file} has {', '.join(there) or 'none of its type'}")
            return named
        likely = [topic for topic in there if not any(word in topic for word in skip)] or there
        if len(likely) > 1:
            raise RevisitError(f"{self._file}: several topics; --{option}-topic names one: {', '.join(likely[:MAX_TOLD])}")
        return likely[0] if likely else None

    def _told(self) -> str:
        topics = sorted({f"{c.topic} ({c.msgtype})" for c in self._reader.connections})
        return ", ".join(topics[:MAX_TOLD]) or "nothing"

    def _calibration(self, image_topic: str, camera_frame: str) -> Calibration | None:
        info = self._camera_info(image_topic, camera_frame)
        if info is None:
            return None
        k, d, p = (info.k, info.d, info.p) if hasattr(info, "k") else (info.K, info.D, info.P)
        if "image_rect" in image_topic:
            fx, fy, cx, cy, terms = p[0], p[5], p[2], p[6], ()
        else:
            fx, fy, cx, cy, terms = k[0], k[4], k[2], k[5], d
        if fx == 0:  # ROS's own mark of a camera that is not calibrated.
            return None
        if info.distortion_model not in MODELS:
            raise RevisitError(f"{self._file}: distortion_model {info.distortion_model} is not known ({', '.join(filter(None, MODELS))})")
        numbers = (float(fx), float(fy), float(cx), float(cy), tuple(float(term) for term in terms))
        size = (info.width, info.height) if info.width and info.height else None
        fisheye = info.distortion_model in FISHEYE and "image_rect" not in image_topic
        return Calibration.read(f"{self._file}, the camera of {image_topic}", *numbers, fisheye, size)

    def _camera_info(self, image_topic: str, camera_frame: str) -> Any | None:
        """Return the camera of a topic of pictures: the one named, the one beside it, or one of the same frame."""
        there = sorted({c.topic for c in self._reader.connections if c.msgtype == CAMERA_INFO})
        beside: list[str] = []
        if self._topics.camera_info is not None:
            there = [topic for topic in (self._one("camera-info", self._topics.camera_info, (CAMERA_INFO,)),) if topic]
        else:
            # By convention it stands beside the pictures: /camera/image_raw, /camera/image_raw/compressed.
            beside = [topic for topic in (f"{parent}/camera_info" for parent in _parents(image_topic)) if topic in there]
            if beside:
                there = beside[:1]
        for topic in there:
            _, info = next(self._messages(topic), (0, None))
            named = self._topics.camera_info is not None or topic in beside
            if info is not None and (named or info.header.frame_id == camera_frame):
                return info
        return None

    def _frames(self, topic: str, calibration: Calibration | None, every_s: float, work: Path) -> list[Frame]:
        frames: list[Frame] = []
        for number, (stamp_ns, message) in enumerate(self._messages(topic)):
            if too_near(frames, stamp_ns, every_s):
                continue
            name = plain_id(f"{self._file.stem}-{number:06}", self._file)
            path = self._save(message, work / name, topic)
            origin = f"{self._file}, picture {number} of {topic}"
            frames.append(Frame(name, path, self._file.stem, number, stamp_ns, calibration=calibration, origin=origin))
        return sorted(frames, key=lambda frame: frame.stamp_ns or 0)

    def _save(self, message: Any, path: Path, topic: str) -> Path:
        if hasattr(message, "format"):
            # As it was compressed.
            path = path.with_name(f"{path.name}.jpg")
            path.write_bytes(bytes(message.data))
            return path
        if message.encoding not in ENCODINGS:
            raise RevisitError(f"{self._file}: pictures on {topic} are {message.encoding}; known: {', '.join(ENCODINGS)}")
        channels = {"mono8": 1, "8UC1": 1, "bgra8": 4, "rgba8": 4}.get(message.encoding, 3)
        rows = np.frombuffer(bytes(message.data), np.uint8).reshape(message.height, message.step)
        image = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
        conversion = ENCODINGS[message.encoding]
        image = image if conversion is None else cv2.cvtColor(image, conversion)
        return save(image, path.with_name(f"{path.name}.jpg"))

    def _odometry(self, camera_frame: str) -> tuple[Trajectory | None, tuple[str, ...]]:
        topic = self._one("odometry", self._topics.odometry, (ODOMETRY,))
        if topic is None:
            return None, (f"no {ODOMETRY} in it: poses are rotations from matches",)
        poses, child = [], ""
        for stamp_ns, message in self._messages(topic):
            child = message.child_frame_id
            p, q = message.pose.pose.position, message.pose.pose.orientation
            translation, quaternion = np.array([p.x, p.y, p.z]), np.array([q.x, q.y, q.z, q.w])
            # Not `<`: a quaternion that is no number is below nothing.
            if np.linalg.norm(quaternion) > 1e-6 and np.isfinite(translation).all():
                poses.append((stamp_ns, translation, quaternion))
        transforms = StaticTransforms()
        for connection in self._reader.connections:
            if connection.msgtype == TF_STATIC and connection.topic.endswith("tf_static"):
                for _, message in self._messages(connection.topic):
                    transforms.add(message)
        base_from_camera = transforms.between(child, camera_frame)
        if base_from_camera is None:
            return None, (
                f"odometry on {topic} is that of {child or 'a frame without a name'}, and nothing on /tf_static joins it to the camera's "
                f"{camera_frame}: poses are rotations from matches",
            )
        return Trajectory(f"{self._file} {topic}", poses, base_from_camera), ()


def _parents(topic: str) -> list[str]:
    parts = topic.split("/")
    return ["/".join(parts[:length]) for length in range(len(parts) - 1, 0, -1)]
