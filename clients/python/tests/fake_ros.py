"""A stand-in for ROS 2: just enough of rclpy for the nodes of `clients/ros2`, with messages made by rosbags.

It shows that a node subscribes, publishes and calls as it should, and never waits. It does not show that ROS itself would
take the node: no middleware, no quality of service, no parameters from outside.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from foreign_messages import Messages

NODES = Path(__file__).resolve().parents[2] / "ros2"
PACKAGES = ("builtin_interfaces", "geometry_msgs", "pose_graph_tools_msgs", "rtabmap_msgs", "sensor_msgs", "std_msgs", "vision_msgs")


class Publisher:
    """Keeps what was published."""

    def __init__(self, kind: str, messages: Messages) -> None:
        self._kind, self._messages = kind, messages
        self.published: list[Any] = []

    def publish(self, message: Any) -> None:
        # Serialised as ROS would: a field of another type or length fails here.
        data = self._messages.store.serialize_cdr(message, self._kind)
        self.published.append(self._messages.store.deserialize_cdr(data, self._kind))


class ServiceClient:
    """Keeps what was called."""

    def __init__(self, messages: Messages) -> None:
        self._messages = messages
        self.called: list[Any] = []
        self.ready = True

    def service_is_ready(self) -> bool:
        return self.ready

    def call_async(self, request: Any) -> None:
        kind = "rtabmap_msgs/msg/Link"
        data = self._messages.store.serialize_cdr(request.link, kind)
        self.called.append(SimpleNamespace(link=self._messages.store.deserialize_cdr(data, kind)))


class Node:
    """What a node asked for, by topic."""

    overrides: dict[str, Any] = {}
    messages: Messages

    def __init__(self, name: str) -> None:
        self.name = name
        self.subscriptions: dict[str, tuple[str, Callable[[Any], None]]] = {}
        self.publishers: dict[str, Publisher] = {}
        self.services: dict[str, ServiceClient] = {}
        self.timers: list[Callable[[], None]] = []
        self.told: list[str] = []

    def declare_parameter(self, name: str, default: Any) -> Any:
        return SimpleNamespace(value=self.overrides.get(name, default))

    def create_subscription(self, kind: Any, topic: str, callback: Callable[[Any], None], _: Any) -> None:
        self.subscriptions[topic] = (kind.kind, callback)

    def create_publisher(self, kind: Any, topic: str, _: Any) -> Publisher:
        self.publishers[topic] = Publisher(kind.kind, self.messages)
        return self.publishers[topic]

    def create_client(self, _: Any, name: str) -> ServiceClient:
        self.services[name] = ServiceClient(self.messages)
        return self.services[name]

    def create_timer(self, _: float, callback: Callable[[], None]) -> None:
        self.timers.append(callback)

    def get_logger(self) -> Any:
        return SimpleNamespace(warning=self.told.append, info=self.told.append)

    def destroy_node(self) -> None:
        pass


class Executor:
    """One thread that calls callbacks, as rclpy's single-threaded executor does."""

    def __init__(self, node: Node, messages: Messages) -> None:
        self._node, self._messages = node, messages

    def deliver(self, topic: str, message: Any) -> None:
        """Deliver a message, through its serialised form."""
        kind, callback = self._node.subscriptions[topic]
        callback(self._messages.store.deserialize_cdr(self._messages.store.serialize_cdr(message, kind), kind))

    def spin_timers(self) -> None:
        """Let each timer fire once."""
        for timer in self._node.timers:
            timer()


def _kind(messages: Messages, kind: str) -> Any:
    """Return what makes a message of a kind, as rclpy's classes do: empty, or from fields."""

    class Kind:
        def __new__(cls, **fields: Any) -> Any:
            return messages.make(kind, **fields)

    Kind.kind = kind
    return Kind


@contextmanager
def running(file: str, kind: str, /, **parameters: Any) -> Iterator[tuple[Any, Executor]]:
    """Run a node file's node with a stand-in for ROS; yield the node and its executor."""
    messages = Messages()
    modules = {"rclpy": ModuleType("rclpy"), "rclpy.node": ModuleType("rclpy.node"), "rclpy.qos": ModuleType("rclpy.qos")}
    node_class = type("Node", (Node,), {"overrides": parameters, "messages": messages})
    modules["rclpy.node"].Node = node_class  # type: ignore[attr-defined]
    modules["rclpy.qos"].qos_profile_sensor_data = 10  # type: ignore[attr-defined]
    for package in PACKAGES:
        module = ModuleType(f"{package}.msg")
        for message in messages.store.fielddefs:
            if message.startswith(f"{package}/msg/"):
                setattr(module, message.rsplit("/", 1)[1], _kind(messages, message))
        modules[package], modules[f"{package}.msg"] = ModuleType(package), module
    modules["rtabmap_msgs.srv"] = ModuleType("rtabmap_msgs.srv")
    modules["rtabmap_msgs.srv"].AddLink = SimpleNamespace(Request=SimpleNamespace)  # type: ignore[attr-defined]
    before = {name: sys.modules.get(name) for name in modules}
    sys.modules.update(modules)
    try:
        spec = importlib.util.spec_from_file_location(f"node_{file}", NODES / f"{file}.py")
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        node = getattr(module, kind)()
        try:
            yield node, Executor(node, messages)
        finally:
            node.destroy_node()
    finally:
        for name, module_before in before.items():
            if module_before is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module_before
