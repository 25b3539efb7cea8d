"""Live hosts: RTAB-Map and any SLAM with poses, pictures and detections, through the nodes of `clients/ros2` and a stand-in for ROS."""

from __future__ import annotations

import json
import threading
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags")

from fake_ros import NODES, running  # noqa: E402
from foreign_maps import LOOP  # noqa: E402
from foreign_messages import Messages  # noqa: E402
from foreign_world import BASE_FROM_CAMERA, CX, CY, FX, FY, HEIGHT, WIDTH, World, placed, turn, world  # noqa: E402

from revisit_slam import Client, Server  # noqa: E402
from revisit_slam.hosts.bridge import Bridge  # noqa: E402
from revisit_slam.hosts.inbox import Inbox  # noqa: E402
from revisit_slam.hosts.loops import Loop, Trust, edge_of, inverse_jacobian, mounted_jacobian  # noqa: E402
from revisit_slam.hosts.pictures import depth_of, picture_of  # noqa: E402
from revisit_slam.hosts.png import png  # noqa: E402
from revisit_slam.hosts.rtabmap import RtabmapBridge  # noqa: E402
from revisit_slam.hosts.stamped import Together  # noqa: E402
from revisit_slam.imports.poses import inverse, matrix  # noqa: E402

PATIENCE_S = 60.0
if not NODES.is_dir():
    pytest.skip("the nodes are beside the package in a checkout only", allow_module_level=True)


@pytest.fixture(scope="module")
def drive() -> World:
    """A drive whose ends see enough of the same for geometry."""
    return world(points=4000, seed=11)


def small_turn(vector: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle if angle else vector
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def nudged(pose: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """Return a pose after a small motion as the API's covariances mean it."""
    return placed(small_turn(motion[3:]) @ pose[:3, :3], pose[:3, 3] + motion[:3])


def motion_between(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    turned = after[:3, :3] @ before[:3, :3].T
    axis = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]]) / 2
    return np.array([*(after[:3, 3] - before[:3, 3]), *axis])


def some_pose(seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    return matrix(random.uniform(-3, 3, 3), random.normal(size=4), "some pose")


@pytest.mark.parametrize("seed", range(4))
def test_small_motions_move_mounted_and_inverted_poses_as_the_jacobians_say(seed: int) -> None:
    left, pose, right = (some_pose(3 * seed + at) for at in range(3))
    cases: list[tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]] = [
        (lambda p: left @ p @ right, mounted_jacobian(left, pose, right)),
        (inverse, inverse_jacobian(pose)),
    ]
    step = 1e-6
    for moved, jacobian in cases:
        for at in range(6):
            motion = np.zeros(6)
            motion[at] = step
            seen = motion_between(moved(pose), moved(nudged(pose, motion))) / step
            assert np.abs(seen - jacobian[:, at]).max() < 1e-4


def test_an_edge_is_where_the_bases_are(drive: World) -> None:
    query, candidate = drive.stands[-1], drive.stands[0]
    cameras = np.linalg.inv(candidate.map_from_camera) @ query.map_from_camera
    edge = edge_of(Loop("q", "c", "a", cameras, None), (2, 1), BASE_FROM_CAMERA, BASE_FROM_CAMERA, Trust(0.1, 0.2))
    assert edge is not None
    assert np.abs(edge.to_from_from - np.linalg.inv(candidate.map_from_base) @ query.map_from_base).max() < 1e-12
    assert np.allclose(edge.covariance, np.diag([0.01] * 3 + [0.04] * 3))
    assert edge_of(Loop("q", "c", "a", None, None), (2, 1), BASE_FROM_CAMERA, BASE_FROM_CAMERA, Trust()) is None


def test_a_covariance_turns_with_the_camera(drive: World) -> None:
    cameras = np.linalg.inv(drive.stands[0].map_from_camera) @ drive.stands[-1].map_from_camera
    # Along the candidate's optical axis nothing is sure: in the base that is ahead, not up.
    loop = Loop("q", "c", "a", cameras, np.diag([0, 0, 1.0, 0, 0, 0]))
    edge = edge_of(loop, (2, 1), BASE_FROM_CAMERA, BASE_FROM_CAMERA, Trust(0.0, 0.0))
    assert edge is not None
    ahead = BASE_FROM_CAMERA[:3, 2]
    assert np.allclose(edge.covariance[:3, :3], np.outer(ahead, ahead)) and abs(ahead[0]) > 0.9


def settled(bridge: Bridge) -> None:
    assert bridge.flush(PATIENCE_S) and bridge.dropped == bridge.refused == 0


def test_rtabmap_gets_a_link_and_the_server_its_confirmation_and_poses(
    server: Server, client: Client, map_id: str, drive: World
) -> None:
    messages = Messages()
    with running("rtabmap_node", "RevisitRtabmap", server=server.url, map=map_id, name="robot", back="both", robot=3) as (node, executor):
        client.patch_map(map_id, {"settings": {"without_anchors": "geometry", "building_repeats": False}})
        count = len(drive.stands)
        for number in range(1, count + 1):
            message = messages.map_data(drive, number)
            # RTAB-Map has not found the loop itself.
            message.graph.links = [link for link in message.graph.links if link.type != LOOP]
            executor.deliver("mapData", message)
            settled(node.bridge)
        node.services["add_link"].ready = False
        executor.spin_timers()
        assert node.bridge.asked == count and node.services["add_link"].called == []
        # Links wait until RTAB-Map is there.
        node.services["add_link"].ready = True
        executor.spin_timers()
        assert len(node.services["add_link"].called) == 1
        link = node.services["add_link"].called[0].link
        assert (link.from_id, link.to_id, link.type) == (count, 1, 4)
        first, last = drive.stands[0], drive.stands[-1]
        told = matrix([getattr(link.transform.translation, a) for a in "xyz"], [getattr(link.transform.rotation, a) for a in "xyzw"], "")
        assert np.abs(told - np.linalg.inv(last.map_from_base) @ first.map_from_base).max() < 0.01
        information = link.information.reshape(6, 6)
        assert np.allclose(information, information.T) and (np.linalg.eigvalsh(information) > 0).all()

        edge = node.publishers["external_loop_closures"].published[0].edges[0]
        assert (edge.type, edge.robot_from, edge.key_from, edge.key_to) == (1, 3, round(last.stamp_s * 1e9), round(first.stamp_s * 1e9))
        pose = matrix([getattr(edge.pose.position, a) for a in "xyz"], [getattr(edge.pose.orientation, a) for a in "xyzw"], "")
        assert np.abs(pose @ told - np.eye(4)).max() < 1e-9

        # RTAB-Map takes the link, and its optimiser moves the drive.
        assert client.list_loops(map_id).items == []
        moved = placed(turn("z", 0.1), [0.5, 0, 0])
        message = messages.map_data(drive, count, moved=moved)
        executor.deliver("mapData", message)
        settled(node.bridge)
        loops = client.list_loops(map_id).items
        assert [(loop.keyframe, loop.candidate) for loop in loops] == [(f"robot-0-{count}", "robot-0-1")]
        for stand in drive.stands:
            stored = client.get_keyframe(map_id, f"robot-0-{stand.number + 1}").pose
            now = matrix([getattr(stored.translation, a) for a in "xyz"], [getattr(stored.rotation, a) for a in "xyzw"], "")
            assert np.abs(now - moved @ stand.map_from_camera).max() < 1e-5
        # The same once more changes nothing, and is not sent again.
        version = client.get_map(map_id).map_version
        executor.deliver("mapData", message)
        settled(node.bridge)
        assert client.get_map(map_id).map_version == version
        executor.spin_timers()
        assert len(node.services["add_link"].called) == 1


def test_loops_that_rtabmap_closed_itself_are_confirmed(server: Server, client: Client, map_id: str, drive: World) -> None:
    messages = Messages()
    with running("rtabmap_node", "RevisitRtabmap", server=server.url, map=map_id, name="robot") as (node, executor):
        for number in range(1, 4):
            executor.deliver("mapData", messages.map_data(drive, number))
        settled(node.bridge)
        kind = "rtabmap_msgs/msg/Info"
        executor.deliver("info", messages.make(kind, ref_id=3, loop_closure_id=1))
        executor.deliver("info", messages.make(kind, ref_id=3, loop_closure_id=0))
        executor.deliver("info", messages.make(kind, ref_id=3, loop_closure_id=77))
        settled(node.bridge)
        assert [(loop.keyframe, loop.candidate) for loop in client.list_loops(map_id).items] == [("robot-0-3", "robot-0-1")]


def test_tags_that_rtabmap_saw_are_detections_where_they_hang(server: Server, client: Client, map_id: str, drive: World) -> None:
    messages = Messages()
    tag = drive.stands[0].map_from_camera @ np.array([0.3, -0.2, 4.0, 1.0])
    with running("rtabmap_node", "RevisitRtabmap", server=server.url, map=map_id, name="robot") as (node, executor):
        message = messages.map_data(drive, 1)
        base_from_tag = placed(np.eye(3), (np.linalg.inv(drive.stands[0].map_from_base) @ tag)[:3])
        link = messages.make(
            "rtabmap_msgs/msg/Link", from_id=1, to_id=-12, type=8, transform=messages.transform(base_from_tag), information=np.zeros(36)
        )
        message.graph.links = [*message.graph.links, link]
        executor.deliver("mapData", message)
        settled(node.bridge)
    seen = client.get_keyframe(map_id, "robot-0-1").detections
    assert [(one.class_, one.text) for one in seen] == [("landmark", "12")]
    assert np.abs(np.array(seen[0].position) - tag[:3]).max() < 1e-6
    u, v = 0.3 / 4 * FX + CX, -0.2 / 4 * FY + CY
    assert np.allclose([(seen[0].box[0] + seen[0].box[2]) / 2, (seen[0].box[1] + seen[0].box[3]) / 2], [u, v])


class Stuck:
    """A client whose server never answers."""

    def __init__(self) -> None:
        self.asked, self.released = threading.Event(), threading.Event()

    def __getattr__(self, _: str) -> Callable[..., Any]:
        def call(*_: Any, **__: Any) -> Any:
            self.asked.set()
            self.released.wait()
            raise OSError("no answer")

        return call


def test_a_server_that_never_answers_holds_no_callback_up(drive: World) -> None:
    """Callbacks run in the test's own thread: if one waited for the server, the test would never end."""
    stuck, messages = Stuck(), Messages()
    bridge = Bridge(stuck, "m")  # type: ignore[arg-type]
    rtabmap = RtabmapBridge(bridge, "robot")
    rtabmap.on_map_data(messages.map_data(drive, 1))
    assert stuck.asked.wait(30), "its thread waits for the server"
    for number in range(1000):
        message = messages.make("rtabmap_msgs/msg/Info", ref_id=number + 2, loop_closure_id=1)
        rtabmap.on_info(message)
        rtabmap.on_map_data(message)
        assert rtabmap.take_links() == []
    # Bounded: what does not fit is dropped, the oldest first, and counted.
    assert bridge.dropped >= 2000 - 256 - 1
    stuck.released.set()
    bridge.close(timeout_s=0.1)


def test_nothing_is_lost_when_the_server_comes_later(tmp_path: Path, drive: World) -> None:
    with Server() as throwaway:
        port = throwaway.url.rsplit(":", 1)[1]
    messages, client = Messages(), Client(f"http://127.0.0.1:{port}")
    bridge = Bridge(client, "late", settings={"without_anchors": "geometry"})
    rtabmap = RtabmapBridge(bridge, "robot")
    for number in range(1, len(drive.stands) + 1):
        rtabmap.on_map_data(messages.map_data(drive, number))
    with Server(listen=f"127.0.0.1:{port}"):
        settled(bridge)
        assert client.get_map("late").keyframes == len(drive.stands)
        assert str(client.get_map("late").settings.without_anchors) == "geometry"
        assert bridge.close() == 0
    client.close()


def test_neighbours_of_a_node_between_keyframes_are_neighbours(drive: World) -> None:
    messages = Messages()
    with Server() as server, Client(server.url) as client:
        bridge = Bridge(client, "between")
        rtabmap = RtabmapBridge(bridge, "robot")
        for number in range(1, 6):
            message = messages.map_data(drive, number)
            message.nodes[0].weight = -1 if number == 3 else 1
            rtabmap.on_map_data(message)
        settled(bridge)
        listed = client.list_keyframes("between").items
        assert len(listed) == 4
        around = {line.keyframe for line in client.list_covisible("between", listed[2].id).items}
        assert {listed[1].id, listed[3].id} <= around, "the node between the second and the third joins them"
        bridge.close()


def picture(messages: Messages, stamp_s: float, encoding: str = "rgb8") -> Any:
    data = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    data[100:120, 200:260] = (250, 10, 20) if encoding == "rgb8" else (20, 10, 250)
    size = {"height": HEIGHT, "width": WIDTH, "step": 3 * WIDTH}
    return messages.make("sensor_msgs/msg/Image", header=messages.header(stamp_s), encoding=encoding, data=data.ravel(), **size)


def detections(messages: Messages, stamp_s: float, text: str, place: np.ndarray | None = None) -> Any:
    centre = messages.make("vision_msgs/msg/Pose2D", position=messages.make("vision_msgs/msg/Point2D", x=230.0, y=110.0))
    box = messages.make("vision_msgs/msg/BoundingBox2D", center=centre, size_x=60.0, size_y=20.0)
    pose = messages.make("geometry_msgs/msg/PoseWithCovariance")
    if place is not None:
        pose.pose.position = messages.vector("Point", place)
    kind = "vision_msgs/msg/ObjectHypothesis"
    results = [
        messages.make(f"{kind}WithPose", hypothesis=messages.make(kind, class_id=name, score=score), pose=pose)
        for name, score in (("door", 0.2), ("door_number", 0.9))
    ]
    one = messages.make("vision_msgs/msg/Detection2D", results=results, bbox=box, id=text)
    empty = messages.make("vision_msgs/msg/Detection2D", bbox=box)
    return messages.make("vision_msgs/msg/Detection2DArray", header=messages.header(stamp_s), detections=[one, empty])


def posed(messages: Messages, stamp_s: float, pose: np.ndarray) -> Any:
    return messages.make("geometry_msgs/msg/PoseStamped", header=messages.header(stamp_s), pose=messages.pose(pose))


def test_any_slam_sends_keyframes_with_signs_and_hears_of_loops(server: Server, client: Client, map_id: str) -> None:
    from revisit_slam.pixels.rotations import quaternion_xyzw

    messages = Messages()
    place = [*BASE_FROM_CAMERA[:3, 3], *quaternion_xyzw(BASE_FROM_CAMERA[:3, :3])]
    parameters = {"server": server.url, "map": map_id, "session": "monday", "text_from": "id", "features": False}
    # A corridor: 901 ahead, two others, and 901 again after odometry has drifted by five metres.
    stops = [(0.0, "901"), (6.0, "915"), (12.0, "927"), (40.0, "901")]
    with running("observations_node", "RevisitObservations", base_from_camera=place, **parameters) as (node, executor):
        executor.deliver("camera_info", messages.camera())
        for number, (x, text) in enumerate(stops):
            at = 1000.0 + 20 * number
            pose = placed(turn("z", 0.1), [x, 0, 0])
            executor.deliver("pose", posed(messages, at - 0.01, pose))
            executor.deliver("image", picture(messages, at))
            executor.deliver("detections", detections(messages, at, text, np.array([0.1, 0.0, 2.0])))
            # A moment later, not far enough to be worth another keyframe.
            executor.deliver("pose", posed(messages, at + 1, pose))
            executor.deliver("image", picture(messages, at + 1))
            executor.deliver("detections", detections(messages, at + 1, text))
            settled(node.bridge)
        executor.spin_timers()
        loops = [json.loads(message.data) for message in node.publishers["loops"].published]
    assert client.get_map(map_id).keyframes == len(stops)
    ids = [f"monday-{(1000 + 20 * number) * 10**9}" for number in range(len(stops))]
    assert [(loop["query"], loop["candidate"]) for loop in loops] == [(ids[3], ids[0])]
    # Signs alone measure no transform: nothing for a pose graph.
    assert loops[0]["candidate_from_query"] is None and node.publishers["external_loop_closures"].published == []
    stored = client.get_keyframe(map_id, ids[1])
    pose = placed(turn("z", 0.1), [6.0, 0, 0]) @ BASE_FROM_CAMERA
    assert np.abs([stored.pose.translation.x - pose[0, 3], stored.pose.translation.y - pose[1, 3]]).max() < 1e-9
    seen = stored.detections
    assert [(one.class_, one.text, one.confidence) for one in seen] == [("door_number", "915", 0.9)]
    assert seen[0].box == [200, 100, 260, 120]
    assert np.abs(np.array(seen[0].position) - (pose @ [0.1, 0, 2, 1])[:3]).max() < 1e-9


def test_with_depth_a_loop_has_an_edge(server: Server, client: Client, map_id: str) -> None:
    """The sample building's first door, seen twice from places a little apart, as a robot with a depth camera sends it."""
    pytest.importorskip("cv2")
    from revisit_slam.sample.building import FOCAL_PX, HEIGHT_PX, WIDTH_PX, walk

    shot = next(iter(walk()))
    messages = Messages()
    k = np.array([FOCAL_PX, 0, WIDTH_PX / 2, 0, FOCAL_PX, HEIGHT_PX / 2, 0, 0, 1])
    parameters = {"server": server.url, "map": map_id, "session": "s", "text_from": "none", "depth": True, "verify": "geometry"}
    with running("observations_node", "RevisitObservations", settings='{"without_anchors": "geometry"}', **parameters) as (node, executor):
        executor.deliver("camera_info", messages.make("sensor_msgs/msg/CameraInfo", width=WIDTH_PX, height=HEIGHT_PX, k=k))
        client.patch_map(map_id, {"settings": {"without_anchors": "geometry", "building_repeats": False}})
        for number, x in enumerate((0.0, 30.0, 60.0)):
            at, header = 100.0 + 10 * number, messages.header(100.0 + 10 * number)
            # Between the two looks at the door: a wall of noise.
            image = shot.image if number != 1 else np.random.default_rng(1).integers(0, 255, shot.image.shape, np.uint8)
            depth = np.where(np.isfinite(shot.depth) & (shot.depth < 20), shot.depth, 0).astype("<f4")
            executor.deliver("pose", posed(messages, at, placed(np.eye(3), [x, 0, 0])))
            kind = "sensor_msgs/msg/Image"
            raw = dict(header=header, height=HEIGHT_PX, width=WIDTH_PX)
            executor.deliver("image", messages.make(kind, **raw, encoding="bgr8", step=3 * WIDTH_PX, data=image.ravel()))
            executor.deliver("depth", messages.make(kind, **raw, encoding="32FC1", step=4 * WIDTH_PX, data=depth.view(np.uint8).ravel()))
            executor.deliver("detections", messages.make("vision_msgs/msg/Detection2DArray", header=header))
            settled(node.bridge)
            if number == 0:
                # Consecutive keyframes are covisible, and so no candidates.
                assert client.get_keyframe(map_id, "s-100000000000").features is not None
        executor.spin_timers()
        edges = [graph.edges[0] for graph in node.publishers["external_loop_closures"].published]
    assert [(edge.key_from, edge.key_to) for edge in edges] == [(120 * 10**9, 100 * 10**9)]
    position = edges[0].pose.position
    # The very same view: drift, not the pose, is what lies between the two.
    assert max(abs(position.x), abs(position.y), abs(position.z)) < 0.01


def test_messages_of_one_moment_come_together_whatever_their_order() -> None:
    together = Together(("detections", "image", "pose"), slop_s=0.05)
    ms = 1_000_000
    assert list(together.add("pose", 990 * ms, "p1")) == []
    assert list(together.add("detections", 1000 * ms, "d1")) == []
    assert list(together.add("pose", 1020 * ms, "p2")) == []
    assert list(together.add("image", 1000 * ms, "i1")) == [(1000 * ms, {"detections": "d1", "image": "i1", "pose": "p1"})]
    # One that lies between two moments serves both.
    assert list(together.add("detections", 1040 * ms, "d2")) == [(1040 * ms, {"detections": "d2", "image": "i1", "pose": "p2"})]
    assert list(together.add("detections", 2000 * ms, "d3")) == []
    assert list(together.add("image", 2060 * ms, "i3")) == []


def test_an_inbox_drops_the_oldest_and_outlives_failures() -> None:
    inbox, done, begun, gate = Inbox("test", 3), [], threading.Event(), threading.Event()
    inbox.put(lambda: (begun.set(), gate.wait()))
    assert begun.wait(PATIENCE_S)
    for number in range(3):
        inbox.put(lambda number=number: done.append(number))
    inbox.put(lambda: 1 / 0)
    inbox.put(lambda: done.append("last"))
    gate.set()
    assert inbox.flush(PATIENCE_S)
    assert done == [2, "last"] and inbox.failed == 1 and inbox.dropped == 2
    inbox.close()


def test_pictures_are_read_in_their_encodings_and_cropped_as_png() -> None:
    messages = Messages()
    for encoding in ("rgb8", "bgr8"):
        read = picture_of(picture(messages, 1.0, encoding))
        assert read[110, 230].tolist() == [250, 10, 20]
    file = png(read[95:125, 190:270])
    assert file.startswith(b"\x89PNG")
    # Independent of any library: the pixels are behind the header, row by row after a zero.
    at = file.index(b"IDAT")
    size = int.from_bytes(file[at - 4 : at], "big")
    rows = np.frombuffer(zlib.decompress(file[at + 4 : at + 4 + size]), np.uint8).reshape(30, 1 + 80 * 3)
    assert (rows[:, 0] == 0).all() and np.array_equal(rows[:, 1:].reshape(30, 80, 3), read[95:125, 190:270])
    millimetres = np.array([[0, 1500], [2500, 65535]], "<u2")
    depth = messages.make("sensor_msgs/msg/Image", height=2, width=2, encoding="16UC1", step=4, data=millimetres.view(np.uint8).ravel())
    assert np.allclose(depth_of(depth), [[0, 1.5], [2.5, 65.535]])
