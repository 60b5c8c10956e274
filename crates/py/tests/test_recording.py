"""results.mcap as other programs see it: the PyPI reader, Foxglove's schemas, the layout of the documentation."""

import hashlib
import json
from pathlib import Path

import anergy
import pytest

reader = pytest.importorskip("mcap.reader")

LAYOUT = Path(__file__).parents[3] / "docs" / "foxglove" / "three-houses.json"
TOPICS = ["/network/nodes", "/network/edges", "/interfaces", "/units", "/control", "/balances"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("recording")
    anergy.examples.load("three-houses").simulate(until_s=600, record_s=10, out=out)
    return out


@pytest.fixture(scope="module")
def recording(folder):
    with (folder / "results.mcap").open("rb") as file:
        yield reader.make_reader(file, validate_crcs=True)


def schemas(recording):
    summary = recording.get_summary()
    return {c.topic: (summary.schemas[c.schema_id], c) for c in summary.channels.values()}


def leaves(schema, path=()):
    """Path and schema of every number."""
    if schema.get("type") == "object":
        for name, inner in schema["properties"].items():
            yield from leaves(inner, (*path, name))
    else:
        yield path, schema


def test_every_number_has_a_unit_in_the_schema_of_its_topic(recording):
    found = schemas(recording)
    for topic in TOPICS:
        schema, channel = found[topic]
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        root = json.loads(schema.data)
        assert root["type"] == "object"
        units = {path: leaf["x-unit"] for path, leaf in leaves(root)}
        assert units[("time_s",)] == "s" and all(units.values())
        for path, unit in units.items():
            wanted = {"_pa": "Pa", "_k": "K", "_kg_s": "kg s-1", "_w": "W", "_j": "J"}
            ends = [unit for end, unit in wanted.items() if path[-1].endswith(end)]
            assert not ends or unit == ends[-1] or path[-1].endswith(("w_k", "j_k")), path
        rows = 0
        for _, _, message in recording.iter_messages(topics=[topic]):
            content = json.loads(message.data)
            assert message.log_time == message.publish_time == round(content["time_s"] * 1e9)
            assert dict(numbers(content)).keys() == units.keys()
            rows += 1
        assert rows == 61


def numbers(content, path=()):
    for name, value in content.items():
        if isinstance(value, dict):
            yield from numbers(value, (*path, name))
        else:
            assert value is None or isinstance(value, float | int)
            yield (*path, name), value


def test_events_and_map_are_messages_that_foxglove_knows(recording):
    found = schemas(recording)
    assert found["/events"][0].name == "foxglove.Log"
    fields = json.loads(found["/events"][0].data)["properties"]
    assert {"timestamp", "level", "message", "name", "file", "line"} <= fields.keys()
    events = [json.loads(m.data) for _, _, m in recording.iter_messages(topics=["/events"])]
    assert any(event["kind"] == "blocked" and event["level"] == 3 for event in events)

    assert found["/network/map"][0].name == "foxglove.GeoJSON"
    (message,) = [m for _, _, m in recording.iter_messages(topics=["/network/map"])]
    network = json.loads(json.loads(message.data)["geojson"])
    names = {feature["properties"]["name"] for feature in network["features"]}
    assert {"sf1", "sf2", "sf4", "sf1-sf2.hot", "sf2-sf4.cold"} <= names
    assert {f["geometry"]["type"] for f in network["features"]} == {"Point", "LineString"}


def test_what_is_needed_to_repeat_the_run_is_in_the_file(recording, folder):
    (metadata,) = [m.metadata for m in recording.iter_metadata() if m.name == "anergy"]
    assert metadata["program"].startswith("anergy ") and metadata["step"] == "1s"
    attached = {a.name: a.data for a in recording.iter_attachments()}
    assert {"header.json", "model.toml", "network.json", "summary.json"} <= attached.keys()
    assert metadata["model_sha256"] == hashlib.sha256(attached["model.toml"]).hexdigest()
    anergy.Model.from_toml(attached["model.toml"].decode())

    again = folder / "again"
    anergy.examples.load("three-houses").simulate(until_s=600, record_s=10, out=again)
    assert (again / "results.mcap").read_bytes() == (folder / "results.mcap").read_bytes()


def test_seeds_are_in_the_metadata(tmp_path):
    text = anergy.examples.load("three-houses").to_toml()
    text += '\n[[sensor]]\nid = "noisy"\nmeasures = "sf1.hot.t_k"\nnoise = 0.1\nseed = 42\n'
    anergy.Model.from_toml(text).simulate(until_s=10, out=tmp_path)
    with (tmp_path / "results.mcap").open("rb") as file:
        (metadata,) = [m.metadata for m in reader.make_reader(file).iter_metadata()]
    assert metadata["random_seeds"] == "noisy 42"


def test_the_layout_of_the_documentation_shows_what_is_recorded(recording):
    layout = json.loads(LAYOUT.read_text(encoding="utf-8"))
    found = schemas(recording)
    known = {
        f"{topic}.{'.'.join(path)}"
        for topic in TOPICS
        for path, _ in leaves(json.loads(found[topic][0].data))
    }
    panels = layout["configById"]
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", [])]
    assert len(paths) >= 15 and set(paths) <= known, set(paths) - known
    assert panels["RosOut!events"]["topicToRender"] in found
    assert panels["RawMessages!edges"]["topicPath"] in found

    def names(part):
        if isinstance(part, str):
            return [part]
        return names(part["first"]) + names(part["second"])

    assert sorted(names(layout["layout"])) == sorted(panels)
