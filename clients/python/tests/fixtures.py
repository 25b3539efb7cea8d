"""Files of other systems' formats, made from the walk through the sample building: synthetic, with its truth."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from revisit_slam.sample.building import FOCAL_PX, HEIGHT_PX, WIDTH_PX, Shot, walk

START_NS = 1_700_000_000_000_000_000
SECOND_NS = 1_000_000_000
# Pictures taken in a lift; the tracker looks back over three.
DARK = 3
# Where the camera sits on the robot: a quarter turn and a lever arm.
BASE_FROM_CAMERA = np.array([[0, 0, 1, 0.2], [-1, 0, 0, 0.05], [0, -1, 0, 0.4], [0, 0, 0, 1]], float)


@dataclass(frozen=True)
class Timed:
    """A photograph with its time and the bytes of its file (those that `revisit-play sample` writes)."""

    shot: Shot
    stamp_ns: int
    jpeg: bytes


def timed(visits: str = "123456") -> list[Timed]:
    """Return the walk's photographs of some visits, one a second; between two visits a lift, where it is dark."""
    shots: list[Shot] = []
    for shot in walk():
        if shot.name[5] not in visits:
            continue
        if shots and shot.name[5] != shots[-1].name[5]:
            shots += [_dark(shots[-1], number) for number in range(DARK)]
        shots.append(shot)
    return [Timed(shot, START_NS + at * SECOND_NS, _jpeg(shot.image)) for at, shot in enumerate(shots)]


def _dark(before: Shot, number: int) -> Shot:
    name = before.name.replace("_frame_", "_lift_").replace("0009", f"{number:04}")
    black, nothing = np.zeros_like(before.image), np.zeros_like(before.depth)
    return Shot(name, before.floor, black, nothing, before.building_from_camera)


def _jpeg(image: np.ndarray) -> bytes:
    return cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 90])[1].tobytes()


def quaternion(matrix: np.ndarray) -> np.ndarray:
    """Return a rotation matrix as x, y, z, w."""
    vector, angle = cv2.Rodrigues(matrix[:3, :3])[0].ravel(), 0.0
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle > 1e-12 else np.array([1.0, 0, 0])
    return np.array([*(axis * np.sin(angle / 2)), np.cos(angle / 2)])


def truth(folder: Path, names: list[tuple[str, str]]) -> Path:
    """Write `truth.csv` for names and floors."""
    with (folder / "truth.csv").open("w", newline="") as file:
        csv.writer(file).writerows([("frame", "floor"), *names])
    return folder / "truth.csv"


def trajectory(path: Path, walked: list[Timed], start_ns: int = 0) -> Path:
    """Write the camera's poses in TUM's format."""
    lines = ["# seconds x y z qx qy qz qw"]
    for one in walked:
        pose = one.shot.building_from_camera
        stamp_ns = one.stamp_ns - start_ns
        numbers = " ".join(f"{value:.9f}" for value in (*pose[:3, 3], *quaternion(pose)))
        lines.append(f"{stamp_ns // SECOND_NS}.{stamp_ns % SECOND_NS:09} {numbers}")
    path.write_text("\n".join(lines) + "\n")
    return path


def tum(folder: Path, walked: list[Timed]) -> Path:
    """Write a sequence of TUM's RGB-D format; its depth images are taken 4 ms later."""
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True)
    listed: dict[str, list[str]] = {"rgb": [], "depth": []}
    for one in walked:
        for name, stamp_ns in (("rgb", one.stamp_ns), ("depth", one.stamp_ns + 4_000_000)):
            stamp = f"{stamp_ns // SECOND_NS}.{stamp_ns % SECOND_NS // 1000:06}"
            file = f"{name}/{stamp}.{'jpg' if name == 'rgb' else 'png'}"
            listed[name].append(f"{stamp} {file}")
            if name == "rgb":
                (folder / file).write_bytes(one.jpeg)
            else:
                depth = np.where(one.shot.depth < 10, one.shot.depth * 5000, 0)
                cv2.imwrite(str(folder / file), depth.astype(np.uint16))
    for name, lines in listed.items():
        (folder / f"{name}.txt").write_text("# timestamp filename\n" + "\n".join(lines) + "\n")
    trajectory(folder / "groundtruth.txt", walked)
    truth(folder, [(f"{one.stamp_ns // SECOND_NS}.000000.jpg", one.shot.floor) for one in walked])
    return folder


def euroc(folder: Path, walked: list[Timed], distortion: str = "[0.0, 0.0, 0.0, 0.0]") -> Path:
    """Write a sequence of EuRoC's format; its ground truth is the body's."""
    camera, body = folder / "mav0" / "cam0", folder / "mav0" / "state_groundtruth_estimate0"
    (camera / "data").mkdir(parents=True)
    body.mkdir(parents=True)
    (camera / "sensor.yaml").write_text(
        "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: "
        f"{[float(value) for value in BASE_FROM_CAMERA.ravel()]}\nresolution: [{WIDTH_PX}, {HEIGHT_PX}]\n"
        f"intrinsics: [{FOCAL_PX}, {FOCAL_PX}, {WIDTH_PX / 2}, {HEIGHT_PX / 2}]\n"
        f"distortion_model: radial-tangential\ndistortion_coefficients: {distortion}\n"
    )
    rows, poses = ["#timestamp [ns],filename"], ["#timestamp, p_x, p_y, p_z, q_w, q_x, q_y, q_z, v_x, v_y, v_z"]
    for one in walked:
        (camera / "data" / f"{one.stamp_ns}.jpg").write_bytes(one.jpeg)
        rows.append(f"{one.stamp_ns},{one.stamp_ns}.jpg")
        # Ground truth comes at other times: between two entries 40 ms apart the body does not move.
        pose = one.shot.building_from_camera @ np.linalg.inv(BASE_FROM_CAMERA)
        x, y, z, w = quaternion(pose)
        for stamp_ns in (one.stamp_ns - 20_000_000, one.stamp_ns + 20_000_000):
            poses.append(",".join(map(str, (stamp_ns, *pose[:3, 3], w, x, y, z, 0.0, 0.0, 0.0))))
    (camera / "data.csv").write_text("\r\n".join(rows) + "\r\n")
    (body / "data.csv").write_text("\n".join(poses) + "\n")
    return folder


def colmap(folder: Path, walked: list[Timed], metres_per_unit: float = 1.0) -> Path:
    """Write a sparse model as text: a point at every 20th pixel of each image, seen by it alone; the images lie beside."""
    (folder / "images").mkdir(parents=True)
    (folder / "sparse").mkdir()
    images, points, next_id = [], [], 1
    for number, one in enumerate(walked, 1):
        (folder / "images" / one.shot.name).write_bytes(one.jpeg)
        pose = one.shot.building_from_camera
        inverse = np.linalg.inv(pose)
        x, y, z, w = quaternion(inverse)
        shift = inverse[:3, 3] / metres_per_unit
        images.append(f"{number} {w} {x} {y} {z} {shift[0]} {shift[1]} {shift[2]} 1 {one.shot.name}")
        seen = []
        for row in range(10, HEIGHT_PX, 20):
            for column in range(10, WIDTH_PX, 20):
                ray = np.array([(column - WIDTH_PX / 2) / FOCAL_PX, (row - HEIGHT_PX / 2) / FOCAL_PX, 1])
                point = (pose[:3, :3] @ (ray * one.shot.depth[row, column]) + pose[:3, 3]) / metres_per_unit
                points.append(f"{next_id} {point[0]} {point[1]} {point[2]} 90 90 90 0.1 {number} {len(seen)}")
                seen.append(f"{column + 0.5} {row + 0.5} {next_id}")
                next_id += 1
        images.append(" ".join(seen))
    camera = f"1 PINHOLE {WIDTH_PX} {HEIGHT_PX} {FOCAL_PX} {FOCAL_PX} {WIDTH_PX / 2 + 0.5} {HEIGHT_PX / 2 + 0.5}"
    for name, lines in (("cameras", [camera]), ("images", images), ("points3D", points)):
        (folder / "sparse" / f"{name}.txt").write_text("\n".join(lines) + "\n")
    return folder / "sparse"


def film(path: Path, walked: list[Timed]) -> Path:
    """Write a film of two pictures a second: each photograph, and a black picture between."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 2.0, (WIDTH_PX, HEIGHT_PX))
    for one in walked:
        writer.write(one.shot.image)
        writer.write(np.zeros_like(one.shot.image))
    writer.release()
    return path


def bag(
    folder: Path,
    walked: list[Timed],
    *,
    raw: bool = False,
    joined: bool = True,
    topic_name: str = "image_raw",
    focal_px: float = FOCAL_PX,
    stamped: bool = True,
    broken: bool = False,
) -> Path:
    """Write a ROS 2 recording as MCAP: pictures, their camera, odometry of the base, and the camera's place on it.

    Not `stamped`: headers carry no time, messages are only recorded at theirs. `broken`: the first picture is no message.
    """
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types

    def header(stamp_ns: int, frame: str) -> object:
        stamp_ns = stamp_ns if stamped else 0
        stamp = types["builtin_interfaces/msg/Time"](sec=stamp_ns // SECOND_NS, nanosec=stamp_ns % SECOND_NS)
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)

    def of(cls: str, *values: float) -> object:
        return types[f"geometry_msgs/msg/{cls}"](*map(float, values))

    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:

        def topic(name: str, cls: str) -> object:
            connection = writer.add_connection(name, cls, typestore=store)
            return lambda stamp_ns, message: writer.write(connection, stamp_ns, store.serialize_cdr(message, cls))

        kind = "Image" if raw else "CompressedImage"
        pictures = topic(f"/camera/{topic_name}" + ("" if raw else "/compressed"), f"sensor_msgs/msg/{kind}")
        if broken:
            writer.write(writer.connections[-1], START_NS, b"\0\1\0\0\xff\xff\xff\xff")
        depths = topic("/camera/depth/image_raw", "sensor_msgs/msg/Image")
        infos = topic("/camera/camera_info", "sensor_msgs/msg/CameraInfo")
        odometry = topic("/odom", "nav_msgs/msg/Odometry")
        static = topic("/tf_static", "tf2_msgs/msg/TFMessage")

        transform = types["geometry_msgs/msg/TransformStamped"](
            header=header(START_NS, "base_link"),
            child_frame_id="optical" if joined else "elsewhere",
            transform=types["geometry_msgs/msg/Transform"](
                translation=of("Vector3", *BASE_FROM_CAMERA[:3, 3]), rotation=of("Quaternion", *quaternion(BASE_FROM_CAMERA))
            ),
        )
        static(START_NS, types["tf2_msgs/msg/TFMessage"](transforms=[transform]))
        image = types["sensor_msgs/msg/Image"]
        for one in walked:
            here = header(one.stamp_ns, "optical")
            infos(one.stamp_ns, _camera_info(types, here, focal_px))
            if raw:
                rgb = np.ascontiguousarray(one.shot.image[:, :, ::-1])
                pictures(one.stamp_ns, image(here, HEIGHT_PX, WIDTH_PX, "rgb8", 0, 3 * WIDTH_PX, rgb.ravel()))
            else:
                data = np.frombuffer(one.jpeg, np.uint8)
                pictures(one.stamp_ns, types["sensor_msgs/msg/CompressedImage"](header=here, format="jpeg", data=data))
            depths(one.stamp_ns, image(here, 1, 1, "16UC1", 0, 2, np.zeros(2, np.uint8)))
            pose = one.shot.building_from_camera @ np.linalg.inv(BASE_FROM_CAMERA)
            posed = types["geometry_msgs/msg/Pose"](
                position=of("Point", *pose[:3, 3]), orientation=of("Quaternion", *quaternion(pose))
            )
            still = types["geometry_msgs/msg/Twist"](linear=of("Vector3", 0, 0, 0), angular=of("Vector3", 0, 0, 0))
            odometry(
                one.stamp_ns,
                types["nav_msgs/msg/Odometry"](
                    header=header(one.stamp_ns, "odom"),
                    child_frame_id="base_link",
                    pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=posed, covariance=np.zeros(36)),
                    twist=types["geometry_msgs/msg/TwistWithCovariance"](twist=still, covariance=np.zeros(36)),
                ),
            )
    return next(folder.glob("*.mcap"))


def _camera_info(types: dict, header: object, focal_px: float) -> object:
    k = np.array([focal_px, 0, WIDTH_PX / 2, 0, focal_px, HEIGHT_PX / 2, 0, 0, 1])
    region = types["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    return types["sensor_msgs/msg/CameraInfo"](
        header=header,
        height=HEIGHT_PX,
        width=WIDTH_PX,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=k,
        r=np.eye(3).ravel(),
        p=np.column_stack((k.reshape(3, 3), np.zeros(3))).ravel(),
        binning_x=0,
        binning_y=0,
        roi=region,
    )
