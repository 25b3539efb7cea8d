"""revisit-play plan: what plans show becomes prior anchors, through the command line. The buildings here are made up."""

import json
import os
from pathlib import Path

import pytest

from revisit_slam import Client, Server
from revisit_slam.play import main

# Two floors at two scales, each with a measurement. Lift A is drawn on the first, and fiducials tell where it is on the second.
BUILDING = """
coordinate_system: reference_image
levels:
  G:
    vertices:
      - [0, 0, 0, ""]
      - [100, 0, 0, ""]
      - [100, 200, 0, "archive"]
      - [300, 200, 0, "charger_1", {is_charger: [4, true]}]
    fiducials:
      - [0, 0, f1]
      - [100, 0, f2]
    measurements:
      - [0, 1, {distance: [3, 10.0]}]
    doors:
      - [0, 1, {name: [1, "G.01"], type: [1, hinged]}]
  "1":
    vertices:
      - [0, 0, 0, ""]
      - [0, 50, 0, ""]
      - [50, 50, 0, "archive"]
    fiducials:
      - [10, 0, f1]
      - [60, 0, f2]
    measurements:
      - [0, 1, {distance: [3, 10.0]}]
    doors:
      - [0, 1, {name: [1, "1.01"], type: [1, hinged]}]
lifts:
  Lift A: {x: 200, y: 100, reference_floor_name: G, level_doors: {G: [d], "1": [d]}}
"""

# About 11.1 m by 11.1 m at the equator; the room's outline has a door in its southern wall.
STEP = 1e-4


def square(x: float, y: float, size: float) -> list[list[float]]:
    return [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]


def feature(kind: str, ring: list[list[float]], **more: str) -> dict:
    return {"type": "Feature", "properties": {"type": kind, **more}, "geometry": {"type": "Polygon", "coordinates": [ring]}}


FLOOR = {
    "type": "FeatureCollection",
    "features": [
        feature("building_outline", square(0, 0, 4 * STEP), name="Annex"),
        feature("room", square(STEP, STEP, STEP), name="Records", roomnumber="204"),
        feature("room", square(3 * STEP, STEP, STEP), name="Vault"),
        feature("door", square(1.5 * STEP - 5e-6, STEP - 5e-6, 1e-5)),
    ],
}

# Synthetic, in the form of OpenStreetMap's Simple Indoor Tagging.
OSM = """<osm version="0.6">
  <node id="1" lat="0" lon="0"/><node id="2" lat="0" lon="0.0001"/>
  <node id="3" lat="0.0001" lon="0.0001"/><node id="4" lat="0.0001" lon="0"/>
  <node id="5" lat="0" lon="0.00005"><tag k="door" v="hinged"/></node>
  <way id="7"><nd ref="1"/><nd ref="5"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
    <tag k="indoor" v="room"/><tag k="level" v="-1-0"/><tag k="ref" v="B7"/><tag k="name" v="Boiler"/></way>
</osm>
"""


def anchors(path: Path, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[dict[str, dict], str]:
    """Read plans into a recording; return the body of each prior anchor, and what was said."""
    output = path.parent / "out.ndjson"
    assert main(["plan", str(path), "-o", str(output), *more]) == 0
    lines = [json.loads(line) for line in output.read_text(encoding="utf-8").splitlines()]
    assert lines[0] == {"op": "map", "id": "building", "body": {"metric": True}}
    said = capsys.readouterr()
    return {line["id"]: line["body"] for line in lines[1:] if line["op"] == "anchor"}, said.out + said.err


def test_a_building_map_is_read_in_metres_floor_by_floor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "made.building.yaml"
    path.write_text(BUILDING)
    found, said = anchors(path, capsys)
    assert {name: body["frame"] for name, body in found.items()} == {
        "G.G.01": "plan:G", "G.archive": "plan:G", "G.Lift_A": "plan:G",
        "1.1.01": "plan:1", "1.archive": "plan:1", "1.Lift_A": "plan:1",
    }  # fmt: skip
    # An image's y points down, a plan's up.
    assert found["G.G.01"]["position"] == [5.0, 0.0, 1.5]
    assert found["G.archive"]["position"] == [10.0, -20.0, 1.5]
    assert found["1.1.01"]["position"] == [0.0, -5.0, 1.5]
    assert found["G.Lift_A"]["position"] == [20.0, -10.0, 1.5]
    assert found["1.Lift_A"]["position"] == [22.0, -10.0, 1.5]
    assert "repeated names align nothing alone: Lift A (2), archive (2)" in said
    assert "charger_1: places of robots" in said
    only, _ = anchors(path, capsys, "--level", "1", "--class", "plate")
    assert set(only) == {"1.1.01", "1.archive", "1.Lift_A"}
    assert {body["class"] for body in only.values()} == {"plate"}


def test_a_map_without_a_measurement_is_rejected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "made.building.yaml"
    path.write_text("levels: {G: {vertices: [[0, 0, 0, a]]}}")
    assert main(["plan", str(path)]) == 1
    assert "no measurement" in capsys.readouterr().err


def test_a_geojson_sign_hangs_at_its_rooms_door_and_faces_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "second floor.geojson"
    path.write_text(json.dumps(FLOOR))
    found, said = anchors(path, capsys, "--level", "2")
    assert set(found) == {"2.204", "2.Vault"}
    x, y, _ = found["2.204"]["position"]
    assert (x, y) == (pytest.approx(1.5 * 11.13, abs=0.05), pytest.approx(11.13, abs=0.05))
    assert found["2.204"]["normal"] == [0.0, -1.0, 0.0]
    assert "Vault has no door" in said
    assert "normal" not in found["2.Vault"]


def test_a_room_of_openstreetmap_is_on_each_of_its_floors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "made.osm"
    path.write_text(OSM)
    found, _ = anchors(path, capsys)
    assert {name: body["frame"] for name, body in found.items()} == {"-1.B7": "plan:-1", "0.B7": "plan:0"}
    assert found["0.B7"]["description"] == "B7"
    assert found["0.B7"]["position"][:2] == [pytest.approx(5.57, abs=0.01), 0.0]
    assert found["0.B7"]["normal"][1] == -1.0


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.osm", "<osm", "not a file of OpenStreetMap"),
        ("a.geojson", "[]", "not a GeoJSON collection"),
        ("a.building.yaml", "- a", "not a building map"),
        ("a.dwg", "", "a plan is"),
        ("a.osm", "<osm/>", "show no signs"),
    ],
)
def test_what_is_no_plan_is_rejected(
    name: str, text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    path.write_text(text)
    assert main(["plan", str(path)]) == 1
    assert told in capsys.readouterr().err


def test_the_signs_are_in_the_map_and_a_second_run_changes_nothing(
    server: Server, client: Client, map_id: str, tmp_path: Path
) -> None:
    path = tmp_path / "made.building.yaml"
    path.write_text(BUILDING)
    versions = set()
    for _ in range(2):
        assert main(["plan", str(path), "--server", server.url, "--map", map_id]) == 0
        listed = client.list_anchors(map_id, prior=True)
        versions.add(listed.map_version)
    assert {anchor.id for anchor in listed.items} == {"G.G.01", "G.archive", "G.Lift_A", "1.1.01", "1.archive", "1.Lift_A"}
    assert len(versions) == 1
    sessions = {session.session: session.priors for session in client.list_sessions(map_id).items}
    assert sessions == {"plan:G": 3, "plan:1": 3}


@pytest.mark.skipif("REVISIT_SHARED" not in os.environ, reason="needs REVISIT_SHARED")
@pytest.mark.parametrize(
    ("plan", "signs"),
    [
        ("rmf/hotel.building.yaml", {"plan:L1": 11, "plan:L2": 12, "plan:L3": 12}),
        ("rmf/office.building.yaml", {"plan:L1": 15}),
        ("rmf/campus.building.yaml", {"plan:L1": 25}),
        ("westport/westport-house-floor-2.geojson", {"plan:westport-house-floor-2": 16}),
    ],
)
def test_plans_of_real_buildings_are_read(
    plan: str, signs: dict[str, int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "out.ndjson"
    path = Path(os.environ["REVISIT_SHARED"]) / "samples" / "plans" / plan
    assert main(["plan", str(path), "-o", str(output)]) == 0
    found: dict[str, int] = {}
    for line in output.read_text(encoding="utf-8").splitlines()[1:]:
        frame = json.loads(line)["body"]["frame"]
        found[frame] = found.get(frame, 0) + 1
    assert found == signs
