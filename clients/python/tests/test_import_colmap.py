"""revisit-play import of COLMAP: real samples and synthetic models, against pycolmap's own reading."""

import re
import shutil
import sqlite3
from pathlib import Path

import numpy as np
import pytest
from imported import Imported, imported, observes, pose_of, projected, refused, shared

pycolmap = pytest.importorskip("pycolmap")

from revisit_slam.imports.opened import Wanted  # noqa: E402
from revisit_slam.imports.opening import open_file  # noqa: E402

# 4 images, 1,039 points, 3,355 observations, of which 5 are of a point seen twice in one image.
IMAGES, POINTS, OBSERVATIONS = 4, 1039, 3350


def assert_equal(found: Imported, model: "pycolmap.Reconstruction", scale: float = 1.0) -> None:
    """Poses, points and observations are those that pycolmap reads, to 1e-9."""
    images = {Path(image.name).with_suffix("").as_posix().replace("/", "."): image for image in model.images.values()}
    assert found.keyframes.keys() == images.keys()
    for id, body in found.keyframes.items():
        read = images[id].cam_from_world()
        # Text files keep six digits of a quaternion; pycolmap's matrix of one that is not of length one is no rotation.
        turned = pycolmap.Rotation3d(read.rotation.quat / np.linalg.norm(read.rotation.quat))
        camera_from_world = np.vstack((pycolmap.Rigid3d(turned, read.translation).matrix(), [0, 0, 0, 1]))
        expected = np.linalg.inv(camera_from_world)
        expected[:3, 3] *= scale
        assert np.abs(pose_of(body) - expected).max() < 1e-9, id
        seen = {point.point3D_id for point in images[id].points2D if point.has_point3D()}
        assert observes(body) == sorted(seen), id
    points = found.points()
    assert {id for _, id in points} == set(model.points3D)
    assert all(np.abs(position - model.points3D[id].xyz * scale).max() < 1e-9 for (_, id), position in points.items())


@pytest.fixture
def model(tmp_path: Path) -> "tuple[Path, pycolmap.Reconstruction]":
    """A synthetic model without noise, as pycolmap makes and writes one."""
    pycolmap.set_random_seed(3)
    options = pycolmap.SyntheticDatasetOptions()
    options.camera_model_id, options.camera_params = pycolmap.CameraModelId.PINHOLE, [1280.0, 1290.0, 512.0, 384.0]
    made = pycolmap.synthesize_dataset(options)
    folder = tmp_path / "synthetic"
    folder.mkdir()
    made.write_binary(str(folder))
    return folder, made


@pytest.mark.parametrize("form", ["txt", "bin"])
def test_a_real_model_is_what_pycolmap_reads(form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = shared() / "samples/colmap/reconstruction"
    expected = pycolmap.Reconstruction(str(folder))
    if form == "bin":
        folder = tmp_path / "binary"
        folder.mkdir()
        expected.write_binary(str(folder))
    found = imported(folder, tmp_path, capsys)
    assert_equal(found, expected)
    assert (len(found.keyframes), len(found.points())) == (IMAGES, POINTS)
    assert sum(len(observes(body)) for body in found.keyframes.values()) == OBSERVATIONS
    assert found.map["metric"] is False and "--metres-per-unit" in found.told
    # COLMAP's pixels begin at a corner, the API's in the middle of a pixel.
    assert {body["camera"]["cx"] for body in found.keyframes.values()} == {959.0}


def test_a_real_database_beside_its_model_tells_which_images_match(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sample = shared() / "samples/colmap"
    before = (sample / "colmap.db").read_bytes()
    found = imported(sample / "reconstruction", tmp_path, capsys, "--database", sample / "colmap.db")
    declared = {
        frozenset((id, other["keyframe"])): other["shared"] for id, body in found.keyframes.items() for other in body.get("covisible", [])
    }
    # On a copy: pycolmap changes a database of an older version when it opens it.
    copy = shutil.copy(sample / "colmap.db", tmp_path / "copy.db")
    (tmp_path / "copy.db").chmod(0o600)
    with pycolmap.Database.open(copy) as database:
        names = {image.image_id: Path(image.name).stem for image in database.read_all_images()}
        expected = {}
        for pair, inliers in zip(*database.read_two_view_geometry_num_inliers()):
            if inliers >= 15:
                ids = pair if isinstance(pair, tuple) else pycolmap.pair_id_to_image_pair(pair)
                expected[frozenset(names[id] for id in ids)] = inliers
    assert declared == expected and len(declared) >= 1
    assert (sample / "colmap.db").read_bytes() == before


def test_a_real_database_alone_has_no_poses_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = imported(shared() / "samples/colmap/colmap.db", tmp_path, capsys)
    assert len(found.keyframes) == IMAGES and "4 images have no prior pose" in found.told
    assert len({body["session"] for body in found.keyframes.values()}) == IMAGES
    assert not any("features" in body for body in found.keyframes.values())


def test_a_pinhole_sees_the_points_where_the_images_have_them(
    model: "tuple[Path, pycolmap.Reconstruction]", tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, made = model
    found = imported(folder, tmp_path, capsys, "--metres-per-unit", "2.5")
    assert_equal(found, made, 2.5)
    assert found.map["metric"] is True
    points = {id: position for (_, id), position in found.points().items()}
    for image in made.images.values():
        body = found.keyframes[Path(image.name).stem]
        seen = [point for point in image.points2D if point.has_point3D()]
        assert seen
        pixels = projected(body, np.array([points[point.point3D_id] for point in seen]))
        # A unit's length changes no pixel; and a wrong order of the quaternion or a pose not inverted would move all.
        assert np.abs(pixels - (np.array([point.xy for point in seen]) - 0.5)).max() < 1e-6


def test_both_forms_of_a_model_become_one_recording(
    model: "tuple[Path, pycolmap.Reconstruction]", tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, made = model
    text = tmp_path / "text"
    text.mkdir()
    made.write_text(str(text))
    one = imported(folder, tmp_path, capsys, "--session", "s", name="one.ndjson")
    other = imported(text, tmp_path, capsys, "--session", "s", name="other.ndjson")
    assert one.keyframes == other.keyframes


def test_names_that_are_times_are_the_stamps(model: "tuple[Path, pycolmap.Reconstruction]", tmp_path: Path) -> None:
    folder, made = model
    for number, image in enumerate(made.images.values()):
        image.name = f"cam/{1700000000 - number}.250000.png"
    made.write_binary(str(folder))
    seen = list(open_file(folder, "auto", Wanted()).keyframes())
    assert [s.stamp_ns for s in seen] == sorted((1700000000 - n) * 10**9 + 250_000_000 for n in range(len(made.images)))
    assert seen[0].id == f"cam.{1700000001 - len(made.images)}.250000"


def test_priors_of_a_database_are_its_poses(tmp_path: Path) -> None:
    database = sqlite3.connect(tmp_path / "priors.db")
    database.executescript(
        """create table cameras (camera_id integer primary key, model integer, width integer, height integer, params blob);
        create table images (image_id integer primary key, name text, camera_id integer, prior_qw real, prior_qx real, prior_qy real,
          prior_qz real, prior_tx real, prior_ty real, prior_tz real);
        create table two_view_geometries (pair_id integer primary key, rows integer, cols integer, data blob, config integer);"""
    )
    database.execute("insert into cameras values (1, 0, 640, 480, ?)", (np.array([500.0, 320.0, 240.0]).tobytes(),))
    half = np.sqrt(0.5)
    # A quarter turn about y, and a metre ahead of the origin as the camera sees it.
    database.execute("insert into images values (1, 'a.png', 1, ?, 0, ?, 0, 0, 0, 1)", (half, half))
    database.execute("insert into images values (2, 'b.png', 1, null, null, null, null, null, null, null)")
    database.execute("insert into two_view_geometries values (?, 20, 2, null, 2)", (1 * (2**31 - 1) + 2,))
    database.commit()
    database.close()
    first, second = open_file(tmp_path / "priors.db", "auto", Wanted()).keyframes()
    camera_from_world = np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 1], [0, 0, 0, 1.0]])
    assert np.abs(first.session_from_camera @ camera_from_world - np.eye(4)).max() < 1e-12
    assert second.covisible == {"a": 20} and second.session != first.session


def test_what_no_model_has_is_told_in_one_line(
    model: "tuple[Path, pycolmap.Reconstruction]", tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, made = model
    whole = (folder / "images.bin").read_bytes()
    (folder / "images.bin").write_bytes((2**40).to_bytes(8, "little") + whole[8:])
    assert "images.bin: it claims 1099511627776 images" in refused(folder, tmp_path, capsys)
    (folder / "images.bin").write_bytes(whole[:-100])
    assert "images.bin: it ends in the middle of an entry" in refused(folder, tmp_path, capsys)
    (folder / "images.bin").write_bytes(whole)
    (folder / "points3D.bin").write_bytes(bytes(8))
    assert "observes point" in refused(folder, tmp_path, capsys)
    (folder / "points3D.bin").unlink()
    assert "no COLMAP model in it" in refused(folder, tmp_path, capsys)
    made.write_text(str(folder))
    lines = (folder / "cameras.txt").read_text().splitlines()
    (folder / "cameras.txt").write_text("\n".join(line.replace("PINHOLE", "PINHOOLE") for line in lines))
    for name in ("cameras.bin", "images.bin", "points3D.bin"):
        (folder / name).unlink(missing_ok=True)
    assert "camera model PINHOOLE is not known" in refused(folder, tmp_path, capsys)
    (folder / "cameras.txt").write_text("1 PINHOLE wide 480 1 1 1 1\n")
    assert "cameras.txt: line 1 is no CAMERA_ID" in refused(folder, tmp_path, capsys)


def test_a_name_of_many_lines_is_told_in_one(
    model: "tuple[Path, pycolmap.Reconstruction]", tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, made = model
    for image in list(made.images.values())[:2]:
        image.name = "long\n" * 500 + ".png"
    made.write_binary(str(folder))
    found = imported(folder, tmp_path, capsys)
    assert len(found.keyframes) == len(made.images) - 1 and "left out 1: is in it twice: image long?long" in found.told
    assert max(map(len, found.told.splitlines())) < 700


def test_two_names_are_two_ids_however_alike_or_long(model: "tuple[Path, pycolmap.Reconstruction]") -> None:
    folder, made = model
    names = ("a.png", "a.jpg", "x/b.png", "x.b.png", "入口.jpg", "出口.jpg", "a b.jpg", f"{'l' * 200}1.jpg", f"{'l' * 200}2.jpg")
    images = list(made.images.values())[: len(names)]
    assert len(images) > 4
    for image, name in zip(images, names):
        image.name = name
    made.write_binary(str(folder))
    ids = [keyframe.id for keyframe in open_file(folder, "auto", Wanted()).keyframes()]
    assert len(set(ids)) == len(ids) == len(made.images)
    assert all(re.fullmatch(r"[A-Za-z0-9._:-]{1,128}", id) for id in ids)
