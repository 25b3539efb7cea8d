"""Synthetic messages of `rtabmap_msgs`, made of the drive of `foreign_world` with rosbags, from the messages' definitions."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from foreign_maps import DRIFT, LOOP, NEIGHBOUR, compressed, in_base
from foreign_world import BASE_FROM_CAMERA, CX, CY, FX, FY, HEIGHT, WIDTH, Stand, World
from ros_definitions import DEFINITIONS
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from revisit_slam.imports.rtabmap.definitions import MAP_DATA, typestore
from revisit_slam.pixels.rotations import quaternion_xyzw

NOTHING = np.zeros(0, np.uint8)


@cache
def _store() -> Any:
    """Return the package's types, and those that the nodes of `clients/ros2` use beside them."""
    store = get_typestore(Stores.EMPTY)
    store.register(typestore().fielddefs)
    types: dict[str, Any] = {}
    for name, text in DEFINITIONS.items():
        types.update(get_types_from_msg(text, name))
    store.register(types)
    return store


class Messages:
    """Makes messages of a store's types."""

    def __init__(self) -> None:
        self.store = _store()
        self._types = self.store.types

    def make(self, kind: str, **fields: Any) -> Any:
        """Return a message; fields that are left out are empty or zero."""
        cls = self._types[kind]
        defaults = {name: self._empty(what) for name, what in self.store.fielddefs[kind][1]}
        return cls(**(defaults | fields))

    def _empty(self, what: Any) -> Any:
        node, of = what
        if node == 1:  # A base type: (name, length of a string).
            return {"string": "", "bool": False}.get(of[0], 0.0 if of[0].startswith("float") else 0)
        if node == 2:  # A message.
            return self.make(of)
        (inner, name), length = of
        if inner == 1 and name[0] != "string":
            return np.zeros(length if node == 3 else 0, name[0])
        return []

    def vector(self, kind: str, values: Any) -> Any:
        return self.make(f"geometry_msgs/msg/{kind}", **dict(zip("xyzw", map(float, values))))

    def pose(self, pose: np.ndarray) -> Any:
        position, turned = self.vector("Point", pose[:3, 3]), self.vector("Quaternion", quaternion_xyzw(pose[:3, :3]))
        return self.make("geometry_msgs/msg/Pose", position=position, orientation=turned)

    def transform(self, pose: np.ndarray) -> Any:
        moved, turned = self.vector("Vector3", pose[:3, 3]), self.vector("Quaternion", quaternion_xyzw(pose[:3, :3]))
        return self.make("geometry_msgs/msg/Transform", translation=moved, rotation=turned)

    def header(self, stamp_s: float = 0.0, frame: str = "map") -> Any:
        stamp = self.make("builtin_interfaces/msg/Time", sec=int(stamp_s), nanosec=int(round(stamp_s % 1 * 1e9)))
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)

    def camera(self) -> Any:
        p = np.array([FX, 0, CX, 0, 0, FY, CY, 0, 0, 0, 1, 0])
        k = np.array([2 * FX, 0, CX, 0, 2 * FY, CY, 0, 0, 1])
        return self.make("sensor_msgs/msg/CameraInfo", width=WIDTH, height=HEIGHT, p=p, k=k, r=np.eye(3).ravel())

    def node(self, world: World, stand: Stand, map_id: int = 0) -> Any:
        """Return a node; words are listed in the order of their numbers, keypoints in that of the picture."""
        order = np.argsort(stand.seen)[::-1]
        keypoints = [
            self.make(
                "rtabmap_msgs/msg/KeyPoint", pt=self.make("rtabmap_msgs/msg/Point2f", x=float(u), y=float(v)), size=31.0,
                angle=float(world.angles_deg[point]), octave=int(point) % 8,
            )
            for point, (u, v) in zip(stand.seen[order], stand.pixels[order])
        ]  # fmt: skip
        places = [self.make("rtabmap_msgs/msg/Point3f", **dict(zip("xyz", map(float, p)))) for p in in_base(world, stand)[order]]
        numbers = stand.seen[order] + 1
        at = np.argsort(numbers)
        data = self.make(
            "rtabmap_msgs/msg/SensorData", left_camera_info=[self.camera()], local_transform=[self.transform(BASE_FROM_CAMERA)]
        )
        return self.make(
            "rtabmap_msgs/msg/Node", id=stand.number + 1, map_id=map_id, weight=1, stamp=stand.stamp_s, data=data,
            pose=self.pose(DRIFT @ stand.map_from_base), word_id_keys=numbers[at].astype(np.int32), word_id_values=at.astype(np.int32),
            word_kpts=keypoints, word_pts=places,
            word_descriptors=np.frombuffer(compressed(world.descriptors[stand.seen[order]]), np.uint8),
        )  # fmt: skip

    def graph(self, stands: list[Stand], links: list[tuple[int, int, int]], moved: np.ndarray | None = None) -> Any:
        """Return the optimised graph of stands; `moved` is what the optimiser did to all of them."""
        moved = np.eye(4) if moved is None else moved
        made = [self.make("rtabmap_msgs/msg/Link", from_id=a, to_id=b, type=kind, information=np.zeros(36)) for a, b, kind in links]
        for link in made:
            link.transform = self.transform(np.eye(4))
        return self.make(
            "rtabmap_msgs/msg/MapGraph", poses_id=np.array([stand.number + 1 for stand in stands], np.int32),
            poses=[self.pose(moved @ stand.map_from_base) for stand in stands], links=made, map_to_odom=self.transform(np.eye(4)),
        )  # fmt: skip

    def map_data(self, world: World, count: int, **more: Any) -> Any:
        """Return the message that came with the `count`-th node."""
        links = [(number + 1, number, NEIGHBOUR) for number in range(1, count)]
        if count == len(world.stands):
            links.append((count, 1, LOOP))
        stands = world.stands[:count]
        header = self.header(stands[-1].stamp_s)
        return self.make(MAP_DATA, header=header, graph=self.graph(stands, links, **more), nodes=[self.node(world, stands[-1])])


def map_data(
    folder: Path, world: World, *, mcap: bool = True, moved: np.ndarray | None = None, between: tuple[int, ...] = ()
) -> Path:
    """Write a recording with a message a node; all but the last have the graph before it was optimised (`moved`).

    The nodes `between` are none of the keyframes, but between them.
    """
    from rosbags.rosbag2 import StoragePlugin, Writer

    messages = Messages()
    plugin = StoragePlugin.MCAP if mcap else StoragePlugin.SQLITE3
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/rtabmap/mapData", MAP_DATA, typestore=messages.store)
        for count in range(1, len(world.stands) + 1):
            last = count == len(world.stands)
            message = messages.map_data(world, count, moved=None if last else moved)
            message.nodes[0].weight = -1 if count in between else 1
            writer.write(connection, int(world.stands[count - 1].stamp_s * 1e9), messages.store.serialize_cdr(message, MAP_DATA))
    return next(folder.glob("*.mcap")) if mcap else folder
