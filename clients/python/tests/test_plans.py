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


def feature(kind: str, ring: list[list[float]], **more: object) -> dict:
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
    assert "left out 1: places of robots, no signs: G: charger_1" in said
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
        ("a.zip", "PK\x03\x04", "and this is a zip archive: unpack it"),
        ("a.geojson", "<?xml version='1.0'?><kml/>", "not a GeoJSON collection of features, but an XML document"),
        ("a.geojson", "version https://git-lfs.github.com/spec/v1", "a pointer of Git LFS: `git lfs pull`"),
        ("a.osm", "<osmChange><delete/></osmChange>", "not a file of OpenStreetMap's XML, but of `osmChange`"),
        ("a.building.yaml", "coordinate_system: utm\nlevels: {}", "utm is not known, only reference_image, web_mercator, "),
        ("a.building.yaml", "coordinate_system: cartesian_meters\nlevels: {G: {vertices: [[0, 0, 0, a], [9999, 0, 0, b]]}}",
         "level G is 10 km across, which no floor is; its places are taken for metres"),
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


METRES = """
coordinate_system: {system}
parameters: {{offset_x: [3, 10.0]}}
levels:
  1:
    measurements: [[0, 1, {{distance: [3, 99.0]}}]]
    vertices: [[{x}, {y}, 0, 101], [{x2}, {y2}, 0, Archive]]
"""


@pytest.mark.parametrize(
    ("system", "places", "told"),
    [
        ("cartesian_meters", (12, 3, 12, 8), ([2, 3], [2, 8])),
        ("wgs84", (103.78, 1.30, 103.78, 1.3001), ([0, 0], [0, 11.13])),
        # A pixel is 40,075 km / 256; its y points down, or is written below zero.
        ("web_mercator", (128, 127.9999, 128.0001, 127.9998), ([0, 0], [15.65, 15.65])),
        ("web_mercator", (128, -127.9999, 128.0001, -127.9998), ([0, 0], [15.65, 15.65])),
        ("reference_image", (0, 0, 0, -99), ([0, 0], [0, 99])),
    ],
)
def test_a_building_map_says_what_its_coordinates_are(
    system: str, places: tuple[float, ...], told: tuple[list[float], ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "made.building.yaml"
    text = METRES.format(system=system, **dict(zip(("x", "y", "x2", "y2"), places)))
    path.write_text("".join(line + "\r\n" for line in text.splitlines()), encoding="utf-16")
    found, _ = anchors(path, capsys, "--level", "1")
    assert [found[name]["position"][:2] for name in ("1.101", "1.Archive")] == [pytest.approx(at, abs=0.02) for at in told]


def test_what_is_broken_in_a_building_map_is_left_out_and_what_is_assumed_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "made.building.yaml"
    path.write_text("""
levels:
  B: {vertices: [[0, 0, 0, cellar]], layers: {scan: {filename: scan.png}}, holes: [], elevation: -3, floors: []}
  G:
    vertices: [[0, 0, 0, ""], [100, 0, 0, null], [x, 0, 0, "oak"], [.nan, 0, 0, elm], 7, [9, 9, 0, {en: ash}], [9, 9, 0]]
    measurements: [[0, 1, {distance: [3, 10.0]}], [0, 77, {distance: [3, 1.0]}], [0, 1, {distance: [1, far]}]]
    doors: [[0, 1, {name: [1, "01"]}], [0, -1, {name: [1, "02"]}], [1, 99, {name: [1, "03"]}], [1], null]
  E:
lifts: {Lift A: {x: 10, y: 0, level_doors: {G: []}, reference_floor_name: G}, Lift B: {level_doors: {G: []}}, Lift C: null}
""")
    found, said = anchors(path, capsys)
    assert {name: body["position"][:2] for name, body in found.items()} == {
        "B.cellar": [0, 0], "G.01": [5, 0], "G.Lift_A": [1, 0], "G.ash": [0.9, -0.9],
    }  # fmt: skip
    for told in (
        "left out 3: no vertex of x, y, z, a name and properties: G: vertex 2, G: vertex 3, G: vertex 4",
        "left out 5: it names no two vertices of its level: G: 1 of measurements, G: 1 of doors",
        "left out 3: a lift without a place: B: Lift C, G: Lift B, G: Lift C",
        "assumed: level B has no measurement: another level's 0.1 m a pixel are taken",
    ):
        assert told in said, said


def located(features: list[object], **more: object) -> str:
    return json.dumps({"type": "FeatureCollection", "features": features, **more}, ensure_ascii=False)


def imdf(kind: str, id: str, ring: list[list[float]] | None, **properties: object) -> dict:
    geometry = ring and {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "id": id, "feature_type": kind, "properties": properties, "geometry": geometry}


GROUND, UPPER, OTHER = (f"{number}1111111-1111-1111-1111-111111111111" for number in "123")
UNITS = [
    imdf("unit", "a", square(0, 0, STEP), category="library", level_id=GROUND, name={"en": "Library", "de": "Bibliothek"}),
    imdf("unit", "b", square(0, 0, STEP), category="office", level_id=UPPER, name='{"en": "Office", "de": "Büro"}'),
    imdf("unit", "c", square(2 * STEP, 0, STEP), category="stairs", level_id=UPPER, name={"fr": "Escalier"}, restriction=None),
    imdf("unit", "d", square(2 * STEP, 0, STEP), category="room", level_id=UPPER, name=["no", "text"]),
    imdf("unit", "e", None, category="room", level_id=UPPER, name={"en": "Nowhere", "de": "Nirgends"}),
    imdf("unit", "f", [[0.0, "x"]], category="room", level_id=UPPER, name={"en": "Broken"}),
]
STOREYS = [
    imdf("level", GROUND, square(0, 0, 4 * STEP), ordinal=0, short_name={"en": "G", "de": "EG"}, name={"en": "Ground"}),
    imdf("level", UPPER, square(0, 0, 4 * STEP), ordinal=1, short_name={"en": "1", "de": "1. OG"}, name=None),
    imdf("level", OTHER, None, ordinal=2, short_name={"en": "1", "de": "1. OG"}),
]
DOOR = {"type": "LineString", "coordinates": [[0.4 * STEP, 0.0], [0.6 * STEP, 0.0]]}
OPENING = imdf("opening", "o", None, level_id=GROUND, door=None) | {"geometry": DOOR}


@pytest.mark.parametrize("archive", [True, False])
def test_names_of_imdf_are_in_one_language_and_on_the_floors_that_its_levels_name(
    archive: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "unit.geojson"
    if archive:
        path.write_text(located(UNITS), encoding="utf-8-sig")
        (tmp_path / "level.geojson").write_text(located(STOREYS))
        (tmp_path / "opening.geojson").write_text(located([OPENING]))
        (tmp_path / "manifest.json").write_text('{"language": "de-DE"}', encoding="utf-16")
    else:
        path.write_text(located([*UNITS, *STOREYS, OPENING]))
    found, said = anchors(path, capsys)
    texts = {"EG": "Bibliothek", "1. OG": "Büro"} if archive else {"G": "Library", "1": "Office"}
    language = "de-DE" if archive else "en"
    where = {(body["frame"].removeprefix("plan:").replace("_", " "), body["description"]) for body in found.values()}
    assert where == {*texts.items(), ([*texts][1], "Escalier")}
    assert f"assumed: of names in en, de, fr those in {language} are taken" in said
    assert "no places that can be read: " in said and "feature 6" in said
    # One of the rooms has an opening in its wall.
    assert {"normal" in body for body in found.values() if body["description"] in texts.values()} == {True, False}
    other, said = anchors(path, capsys, "--language", "de" if not archive else "en", "--level", "1. OG" if not archive else "1")
    assert {body["description"] for body in other.values()} == ({"Büro", "Escalier"} if not archive else {"Office", "Escalier"})
    assert "assumed" not in said


def test_a_level_that_nothing_names_is_told_and_named_by_hand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "unit.geojson"
    path.write_text(located(UNITS[:1]))
    found, said = anchors(path, capsys)
    assert set(found) == {f"{GROUND}.Library"}
    assert f"nothing tells the name of level {GROUND}: put level.geojson beside it" in said
    assert set(anchors(path, capsys, "--level", "G")[0]) == {"G.Library"}


def test_two_floors_with_one_name_are_two(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "unit.geojson"
    more = imdf("unit", "g", square(0, 0, STEP), category="room", level_id=OTHER, name={"en": "Attic"})
    path.write_text(located([*UNITS[1:2], more, *STOREYS]))
    assert set(anchors(path, capsys)[0]) == {"1.Office", "1.2.Attic"}


def test_a_feature_may_be_on_several_floors_and_level_picks_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "made.geojson"
    rooms = [("7", "0;1"), (8, [1.0, 2]), (9.0, 2), (True, 2)]
    path.write_text(located([feature("room", square(0, 0, STEP), ref=ref, level=level) for ref, level in rooms]))
    assert set(anchors(path, capsys)[0]) == {"0.7", "1.7", "1.8", "2.8", "2.9"}
    assert set(anchors(path, capsys, "--level", "1")[0]) == {"1.7", "1.8"}


ROOM = feature("room", square(0, 0, STEP), ref="12")
FAR = feature("room", square(56, 0, STEP), ref="13")


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"features": [feature("room", square(5e5, 5.9e6, 5), ref="12")]}, "are no degrees of longitude and latitude: `ogr2ogr"),
        ({"features": [ROOM, FAR]}, "km across, which no floor is; its places are taken for degrees (`ogr2ogr"),
        ({"features": [feature("room", square(3 * n, 2, 2), ref=str(n)) for n in range(9)]}, "km across, which no floor is"),
        ({"features": [ROOM], "crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}}, "EPSG::3857"),
        ({"features": [ROOM], "crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}}, "-t_srs EPSG:4326"),
    ],
)
def test_places_that_are_no_degrees_are_refused(
    more: dict, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "made.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", **more}))
    assert main(["plan", str(path)]) == 1
    assert told in capsys.readouterr().err


def test_one_room_elsewhere_does_not_end_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "made.geojson"
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    nan = {"type": "Feature", "properties": {"ref": "x"}, "geometry": {"type": "Point", "coordinates": [float("nan"), 0]}}
    rooms = [feature("room", square(10 + 2 * n * STEP, 50, STEP), ref=str(n)) for n in range(3)]
    path.write_text(located([feature("room", square(0, 0, STEP), ref="null island"), *rooms, nan, "no feature"], crs=crs))
    found, said = anchors(path, capsys, "--level", "2")
    assert set(found) == {"2.0", "2.1", "2.2"}
    assert 0 < found["2.0"]["position"][0] < 10
    assert "left out 1: km away from the other signs of its floor: 2: null island" in said
    assert "feature 5, made.geojson, feature 6" in said


# As JOSM saves what is not uploaded yet: deleted elements stay in the file.
EDITED = """<osm version="0.6" generator="JOSM">
  <node id="1" lat="0" lon="0"/><node id="2" lat="0" lon="0.0001"/><node id="3" lat="0.0001" lon="0.0001"/>
  <node id="4" lat="0.0001" lon="0"/><node id="5" visible="false"/><node id="6" lat="high" lon="0"/>
  <node id="7" lat="nan" lon="0"/>
  <node id="8" action="delete" lat="0" lon="0.00005"><tag k="door" v="hinged"/></node>
  <way id="10" action="delete"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/>
    <tag k="indoor" v="room"/><tag k="level" v="0"/><tag k="ref" v="gone"/></way>
  <way id="11" visible="true"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/>
    <tag k="indoor" v="room"/><tag k="level" v="0"/><tag k="ref" v="old"/></way>
  <way id="11" visible="false"/>
  <way id="12" action="modify"><nd ref="1"/><nd ref="8"/><nd ref="2"/><nd ref="99"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
    <tag k="indoor" v="room"/><tag k="name" v="Hall"/><tag k="name:de" v="Saal"/></way>
  <way id="13"><nd ref="1"/><nd ref="2"/><nd ref="3"/></way>
  <way id="14"><nd ref="1"/><nd ref="4"/><nd ref="3"/></way>
  <way id="15"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/></way>
  <relation id="20"><member type="way" ref="15" role="outer"/><member type="way" ref="14" role="inner"/>
    <tag k="type" v="multipolygon"/><tag k="indoor" v="room"/><tag k="level" v="1"/><tag k="repeat_on" v="3"/>
    <tag k="ref" v="R2"/></relation>
  <relation id="21"><member type="way" ref="13" role="outer"/><member type="way" ref="14" role="outer"/>
    <tag k="type" v="multipolygon"/><tag k="indoor" v="room"/><tag k="ref" v="R3"/></relation>
  <relation id="22" action="delete"><member type="way" ref="13" role="outer"/><tag k="indoor" v="room"/></relation>
</osm>
"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_what_was_deleted_in_openstreetmap_bears_no_sign(
    encoding: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "made.osm"
    path.write_text("<?xml version='1.0' encoding='UTF-8'?>\n" + EDITED, encoding=encoding)
    found, said = anchors(path, capsys)
    assert set(found) == {"0.Hall", "1.R2", "3.R2"}
    assert found["1.R2"]["position"][:2] == [pytest.approx(5.57, abs=0.01)] * 2
    for told in (
        "left out 1: it has no place: node 6",
        "left out 2: it is not in the file: node 8 of Hall, node 99 of Hall",
        "left out 1: a room of several outer ways: draw it as one: relation 21",
        "assumed: 1 rooms tell no level, and are taken for level 0",
    ):
        assert told in said, said
    assert set(anchors(path, capsys, "--level", "4", "--language", "de")[0]) == {"4.Saal"}


def test_a_plan_that_cannot_be_read_ends_its_own_file_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, bad = tmp_path / "made.osm", tmp_path / "made.geojson"
    good.write_text(OSM)
    bad.write_bytes(b"\x1f\x8b\x08\x00\xff")
    assert main(["plan", str(bad), str(good), "-o", str(tmp_path / "out.ndjson")]) == 0
    told = f"left out: {bad}: not a GeoJSON collection of features, but compressed with gzip: unpack it"
    assert told in capsys.readouterr().err
    assert main(["plan", str(bad), str(tmp_path / "none.osm")]) == 1
    said = capsys.readouterr().err
    assert str(bad) in said and "none.osm: cannot be read: No such file or directory" in said


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
