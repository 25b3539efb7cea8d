"""Trajectories of other programs: which column is which, in what unit, and what is no pose. All lines here are made up."""

from pathlib import Path

import pytest

pytest.importorskip("numpy")

import numpy as np  # noqa: E402

from revisit_slam.errors import RevisitError  # noqa: E402
from revisit_slam.pixels.trajectory import Trajectory, read_tum  # noqa: E402

TURN = "0 0.6 0 0.8"
# The same pose at the same time, as programs write it.
TIME_NS, PLACE = 1_700_000_000_250_000_000, (1.5, -2.0, 0.25)
EUROC = (
    "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x [m s^-1], b_w_RS_S_x [rad s^-1], b_a_RS_S_x [m s^-2]\n"
    f"{TIME_NS},1.5,-2,0.25,0.8,0,0.6,0,9,9,9\n"
)
ROSTOPIC = (
    "%time,field.header.seq,field.header.frame_id,field.pose.pose.position.x,field.pose.pose.position.y,"
    "field.pose.pose.position.z,field.pose.pose.orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,"
    "field.pose.pose.orientation.w,field.pose.covariance0,field.twist.twist.linear.x\n"
    f"{TIME_NS},7,odom,1.5,-2,0.25,0,0.6,0,0.8,0,9\n"
)
FORMS = {
    "TUM's": f"# ground truth\n# file: 'walk.bag'\n# timestamp tx ty tz qx qy qz qw\n1700000000.25 1.5 -2 0.25 {TURN}\n",
    "TUM's without a comment": f"1700000000.2500 1.5 -2 0.25 {TURN}\n",
    "RTAB-Map's with ids": f"#timestamp x y z qx qy qz qw id\n1700000000.250000 1.5 -2 0.25 {TURN} 12\n",
    "EuRoC's ground truth": EUROC,
    "ORB-SLAM3's": f"{TIME_NS}.000000 1.5 -2 0.25 {TURN}\n",
    "ORB-SLAM3's of another version": f"{TIME_NS} 1.5 -2 0.25 {TURN}\n",
    "milliseconds": f"1700000000250 1.5 -2 0.25 {TURN}\n",
    "microseconds": f"1700000000250000 1.5 -2 0.25 {TURN}\n",
    "a German Excel's": "\"Timestamp (µs)\";qw;qx;qy;qz;z;y;x\n1700000000250000;0,8;0;0,6;0;0,25;-2;1,5\n",
    "millimetres": f"time[ms] x[mm] y[mm] z[mm] qx qy qz qw\n1700000000250 1500 -2000 250 {TURN}\n",
    "pandas'": f",timestamp_ns,tx,ty,tz,qx,qy,qz,qw,valid\n0,{TIME_NS},1.5,-2,0.25,0,0.6,0,0.8,True\n",
    "rostopic's": ROSTOPIC,
    "tabs": "1700000000.25\t1.5\t-2\t0.25\t" + TURN.replace(" ", "\t") + "\n",
}


def read(tmp_path: Path, text: str, encoding: str = "utf-8") -> Trajectory:
    path = tmp_path / "poses.txt"
    path.write_bytes(text.encode(encoding))
    return read_tum(path)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_pose_is_the_same_however_it_is_written(form: str, encoding: str, tmp_path: Path) -> None:
    pose = read(tmp_path, FORMS[form].replace("\n", "\r\n"), encoding).at(TIME_NS)
    assert pose is not None
    assert np.allclose(pose[:3, 3], PLACE)
    assert np.allclose(pose[:3, 0], (0.28, 0, -0.96))


def test_what_is_assumed_of_times_is_said_and_what_the_file_says_is_not(tmp_path: Path) -> None:
    told = ("times are in nanoseconds, by their digits", "quaternions are x y z w")
    assert read(tmp_path, FORMS["ORB-SLAM3's"]).assumed == told
    for form in ("TUM's", "TUM's without a comment", "EuRoC's ground truth", "millimetres"):
        assert read(tmp_path, FORMS[form]).assumed == (), form


def test_bad_lines_are_left_out_and_named(tmp_path: Path) -> None:
    bad = ["2 nan 0 0 0 0 0 1", "3 0 0 0 0 0 0 0", "4 0 0", "5 1e12 0 0 0 0 0 1", "6 x 0 0 0 0 0 1", "inf 0 0 0 0 0 0 1"]
    good = [f"{second} 0 0 0 0 0 0 1" for second in range(10, 17)]
    trajectory = read(tmp_path, "\n".join(["nan nan nan nan nan nan nan nan", *bad[:5], *good, bad[5]]) + "\n")
    assert trajectory.span_s == (10, 16)
    assert sorted(trajectory.left_out.told()) == [
        "left out 1: a position beyond 1e+09 m: line 5",
        "left out 1: no numbers: line 6",
        "left out 1: no quaternion of length 1: line 3",
        "left out 1: not of 8 columns: line 4",
        "left out 3: no finite numbers: line 1, line 2, line 14",
    ]


def test_landmarks_after_the_poses_of_rtabmap_are_told_and_are_no_poses(tmp_path: Path) -> None:
    poses = [f"17000000{second}.250000 1.5 -2 0.25 {TURN} {second}" for second in (10, 11, 12)]
    landmarks = [f"0.000000 4 1 0.5 {TURN} {-tag}" for tag in (12, 7)]
    trajectory = read(tmp_path, "\n".join(["#timestamp x y z qx qy qz qw id", *poses, *landmarks]) + "\n")
    assert trajectory.assumed == ("2 lines without a time are landmarks of RTAB-Map",)
    assert trajectory.span_s == pytest.approx((1_700_000_010.25, 1_700_000_012.25), abs=1e-6, rel=0)
    assert trajectory.at(0) is None and trajectory.left_out.told() == []


def test_poses_from_time_zero_on_are_poses(tmp_path: Path) -> None:
    trajectory = read(tmp_path, "".join(f"{tenth / 10} {tenth} 0 0 {TURN}\n" for tenth in range(5)))
    assert trajectory.span_s == (0, 0.4) and trajectory.assumed == ()


GRAPH = "a pose graph without times. RTAB-Map writes times with `rtabmap-export --poses_camera --poses_format 10`"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("VERTEX3 1 0 0 0 0 0 0\nVERTEX3 2 1 0 0 0 0 0\nEDGE3 1 2 1 0 0 0 0 0 1 0 0\n", GRAPH),
        (f"PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 {TURN}\n", GRAPH),
        (f"VERTEX_SE3:QUAT 1 0 0 0 {TURN}\nVERTEX_SE3:QUAT 2 1 0 0 {TURN}\n", GRAPH),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n" * 2, "12 numbers a line: a matrix without a time. RTAB-Map writes times with"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", "16 numbers a line: a matrix"),
        (f"1 0 0 0 {TURN} 5\n", "9 numbers a line"),
        (f"0 0 0 {TURN}\n", "7 numbers a line"),
        ("# timestamp x y z roll pitch yaw ok\n1 0 0 0 0 0 0 1\n", "line 1: no line of `seconds x y z qx qy qz qw`; as names"),
        ("t,lon,lat,h,a,b,c,d\n1,0,0,0,0,0,0,1\n", "it lacks x, y, z, qx, qy, qz, qw"),
        (f"secs nsecs x y z qx qy qz qw\n1 5 0 0 0 {TURN}\n", "it lacks t"),
        ("1 2e9 0 0 0 0 0 1\n", "a position beyond 1e+09 m: line 1"),
        ("1 0 0 0 0 0 0 0\n2 0 0 0 0 0 0 0\n3 0 0 0 0 0 0 1\n", "left out 2: no quaternion of length 1: line 1, line 2"),
        ("1 0 0 0 30 60 90 1\n", "no quaternion of length 1"),
        ("".join(f"{5_000_000_000 + second * 33_333_333} 0 0 0 {TURN}\n" for second in range(5)), "name it in a first line"),
        (f"12345678901234567 0 0 0 {TURN}\n", "the unit of times like 12345678901234567 is not known"),
        ("", "no poses in it"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "a pointer of Git LFS: `git lfs pull`"),
    ],
)
def test_what_cannot_be_a_trajectory_is_refused_with_the_next_step(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(RevisitError) as error:
        read(tmp_path, text)
    assert told in str(error.value) and str(tmp_path / "poses.txt") in str(error.value)


def test_a_compressed_trajectory_says_what_it_is(tmp_path: Path) -> None:
    (tmp_path / "poses.txt").write_bytes(b"\x1f\x8b\x08\x00\xff\xff")
    with pytest.raises(RevisitError, match="compressed with gzip: unpack it"):
        read_tum(tmp_path / "poses.txt")
