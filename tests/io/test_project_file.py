"""A project file is whole or absent, tells any damage, and loses nothing that it does not know."""

import hashlib
import json
import resource
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from studio.core.constraints.scope import EVERYONE
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.io.project.archive import stamp
from studio.io.project.entity_json import project_json
from studio.io.project.project_file import ChangedOnDisk, FolderNotWritable, read_project, write_project
from studio.io.project.upgrades import upgraded_record
from tests.builders import make_constraint, make_project

ID = "0123456789abcdef0123456789abcdef"
SAMPLES = Path(__file__).parents[1] / "data" / "versions"
DAMAGED = 200


def state(project: Project) -> bytes:
    return project_json(project, {})


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    path = tmp_path / "walk.studio"
    write_project(path, make_project(), ID, thumbnail=b"a picture")
    return path


def test_what_is_saved_is_read_back_to_the_byte(saved: Path) -> None:
    opened = read_project(saved)
    assert opened.problems == ()
    assert (opened.document_id, opened.read_only) == (ID, False)
    assert state(opened.project) == state(make_project())
    again = saved.with_name("again.studio")
    write_project(again, opened.project, ID, thumbnail=b"a picture")
    assert again.read_bytes() == saved.read_bytes()


def test_the_file_is_a_zip_of_stored_members_with_their_sums_in_a_manifest(saved: Path) -> None:
    with zipfile.ZipFile(saved) as archive:
        manifest = json.loads(archive.read("manifest.json"))
        for entry in archive.infolist():
            assert entry.compress_type == zipfile.ZIP_STORED
            if entry.filename != "manifest.json":
                content = archive.read(entry)
                expected = {"sha256": hashlib.sha256(content).hexdigest(), "size": len(content)}
                assert manifest["members"][entry.filename] == expected
    assert manifest["document"] == ID


def test_each_entity_stands_on_one_line(saved: Path) -> None:
    with zipfile.ZipFile(saved) as archive:
        lines = archive.read("project.json").decode().splitlines()
    assert sum('"kind":"position"' in line for line in lines) == 1
    assert sum('"point":"left_heel"' in line for line in lines) == 1


def test_the_last_ten_versions_stay_in_the_file(saved: Path) -> None:
    project = make_project()
    for step in range(14):
        write_project(saved, project.with_entity("props", "box", Prop(f"Box {step}")), ID)
    opened = read_project(saved)
    assert len(opened.versions) == 10
    assert read_project(saved, opened.versions[0]).project.props["box"].name == "Box 12"
    assert read_project(saved, opened.versions[-1]).project.props["box"].name == "Box 3"


def test_a_version_keeps_the_captures_that_are_gone_since(saved: Path) -> None:
    write_project(saved, Project(), ID)
    opened = read_project(saved)
    assert not opened.project.captures
    assert state(read_project(saved, opened.versions[0]).project) == state(make_project())


def test_any_flipped_byte_or_truncation_is_told_and_what_opens_is_what_was_saved(saved: Path) -> None:
    content, whole, chance = saved.read_bytes(), make_project(), Random(5)
    refused = salvaged = 0
    for case in range(DAMAGED):
        if case % 4:
            place = chance.randrange(len(content))
            flipped = bytes([content[place] ^ (1 << chance.randrange(8))])
            saved.write_bytes(content[:place] + flipped + content[place + 1 :])
        else:
            saved.write_bytes(content[: chance.randrange(len(content))])
        try:
            opened = read_project(saved)
        except StudioError as error:
            refused += "walk.studio" in str(error)
            continue
        assert opened.problems
        salvaged += 1
        for name in ("captures", "characters", "constraints", "contacts", "performers"):
            for key, entity in getattr(opened.project, name).items():
                alone = Project(**{name: {key: entity}})
                assert state(alone) == state(Project(**{name: {key: whole.get(name, key)}}))
    assert refused + salvaged == DAMAGED
    assert salvaged > refused


def test_a_damaged_capture_is_named_and_everything_else_opens(saved: Path) -> None:
    content = bytearray(saved.read_bytes())
    with zipfile.ZipFile(saved) as archive:
        member = max(archive.infolist(), key=lambda entry: entry.file_size)
    content[member.header_offset + len(member.filename) + 300] ^= 255
    saved.write_bytes(content)
    opened = read_project(saved)
    assert any(member.filename in problem for problem in opened.problems)
    assert not opened.project.captures
    assert len(opened.project.characters) == 2


def test_a_damaged_project_json_opens_the_version_before(saved: Path) -> None:
    write_project(saved, make_project().with_entity("props", "box", Prop("Box")), ID)
    content = saved.read_bytes().replace(b'"name":"Box"', b'"name":"Bax"', 1)
    saved.write_bytes(content)
    opened = read_project(saved)
    assert any("project.json" in problem for problem in opened.problems)
    assert state(opened.project) == state(make_project())


def repacked(path: Path, change: object, compression: int = zipfile.ZIP_STORED) -> None:
    """Another program's doing: ``change`` of project.json, packed anew without manifest and seal."""
    with zipfile.ZipFile(path) as archive:
        members = {entry.filename: archive.read(entry) for entry in archive.infolist()}
    del members["manifest.json"]
    record = json.loads(members["project.json"])
    change(record)  # type: ignore[operator]
    members["project.json"] = json.dumps(record).encode()
    with zipfile.ZipFile(path, "w", compression) as archive:
        for name, content in members.items():
            archive.writestr(name, content)


def test_a_file_packed_anew_with_compression_still_opens(saved: Path) -> None:
    repacked(saved, lambda record: None, zipfile.ZIP_DEFLATED)
    opened = read_project(saved)
    assert state(opened.project) == state(make_project())
    assert opened.problems


def test_a_file_of_a_newer_version_opens_read_only(saved: Path) -> None:
    repacked(saved, lambda record: record.update(schema=3))
    opened = read_project(saved)
    assert opened.read_only
    assert any("newer version" in problem for problem in opened.problems)
    assert len(opened.project.characters) == 2


def test_unknown_fields_and_entities_are_written_back(saved: Path) -> None:
    def widen(record: dict) -> None:
        record["lights"] = [{"id": "sun", "angle": 3}]
        record["constraints"].append({"id": "new", "kind": "magnet", "motion_id": "motion", "force": 3})
        record["constraints"][0]["colour"] = "red"
        record["constraints"][0]["activation"]["bounce"] = 0.5
        record["performers"][0]["clips"][0]["blend"] = {"frames": 12}
        record["motions"].append({"id": "later", "schema": 7, "layers": []})
        record["contacts"].append({"id": "on it", "motion_id": "later", "point": "left_toe", "first": 0, "last": 1})

    repacked(saved, widen)
    opened = read_project(saved)
    assert len(opened.project.constraints) == 1
    assert sum("does not know it" in remark for remark in opened.remarks) == 3
    moved = replace(opened.project.constraints["constraint 0"], target=(1.0, 2.0, 3.0))
    again = saved.with_name("again.studio")
    write_project(again, opened.project.with_entity("constraints", "constraint 0", moved), ID)
    with zipfile.ZipFile(again) as archive:
        record = json.loads(archive.read("project.json"))
    by_id = {item["id"]: item for name in ("constraints", "motions", "contacts", "performers") for item in record[name]}
    assert record["lights"] == [{"id": "sun", "angle": 3}]
    assert by_id["new"]["force"] == 3
    assert by_id["constraint 0"]["colour"] == "red"
    assert by_id["constraint 0"]["activation"]["bounce"] == 0.5
    assert [item["clips"][0].get("blend") for item in record["performers"]] == [{"frames": 12}, None]
    assert by_id["constraint 0"]["target"] == [1.0, 2.0, 3.0]
    assert by_id["later"]["schema"] == 7
    assert by_id["on it"]["last"] == 1


@pytest.mark.parametrize(
    "spoil",
    [
        lambda record: record["constraints"][0].update(priority="high"),
        lambda record: record["constraints"][0].update(target=[1, 2]),
        lambda record: record["constraints"][0].update(activation={"start": 3}),
        lambda record: record["constraints"][0].pop("point"),
        lambda record: record["constraints"].append(4),
        lambda record: record["constraints"].append({"id": "constraint 0"}),
        lambda record: record.update(constraints="none"),
        lambda record: record["captures"][0]["poses"].update(local_rotations={"member": "../../etc/passwd"}),
        lambda record: record["captures"][0]["poses"].update(local_rotations=[[1, [2]]]),
        lambda record: record["captures"][0]["poses"].update(local_rotations={"member": 5}),
        lambda record: record["captures"][0]["skeleton"].update(parents=[-1, 7]),
        lambda record: record["captures"][0].update(frame_rate=0),
        lambda record: record["characters"][0]["proportions"].update(stature=900),
        lambda record: record["performers"][0].update(character_id="nobody"),
    ],
)
def test_a_record_that_makes_no_sense_is_left_out_and_told(saved: Path, spoil: object) -> None:
    repacked(saved, spoil)
    opened = read_project(saved)
    assert opened.problems
    assert opened.project.ground.height == 0.0


def test_a_save_is_whole_or_absent_at_every_size_limit(saved: Path) -> None:
    """The disk is full after so many bytes: the old file stays, and nothing lies about."""
    old = saved.read_bytes()
    other = make_project(characters=1, frames=4)
    needed = saved.with_name("needed.studio")
    write_project(needed, other, ID)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    failures = 0
    for limit in range(0, len(needed.read_bytes()), 29):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
        try:
            with pytest.raises(StudioError, match="no room"):
                write_project(saved, other, ID)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert saved.read_bytes() == old
        failures += 1
    assert failures > 250
    assert sorted(item.name for item in saved.parent.iterdir()) == ["needed.studio", "walk.studio"]


def test_a_folder_that_cannot_be_written_is_told_with_another_way(saved: Path) -> None:
    with pytest.raises(FolderNotWritable, match="Save as"):
        write_project(saved.parent / "gone" / "walk.studio", make_project(), ID)


def test_a_cancelled_save_leaves_the_old_file(saved: Path) -> None:
    class StopError(Exception):
        pass

    def stop(share: float, _text: str) -> None:
        if share > 0.5:
            raise StopError

    old = saved.read_bytes()
    with pytest.raises(StopError):
        write_project(saved, make_project(frames=90), ID, report=stop)
    assert saved.read_bytes() == old
    assert [item.name for item in saved.parent.iterdir()] == ["walk.studio"]


def test_a_file_that_somebody_else_changed_is_not_replaced_unasked(saved: Path) -> None:
    opened = read_project(saved)
    write_project(saved, Project(), ID)
    with pytest.raises(ChangedOnDisk):
        write_project(saved, opened.project, ID, expected=opened.stamp)
    write_project(saved, opened.project, ID, expected=stamp(saved))


def test_the_frozen_sample_of_every_schema_opens_without_a_loss(tmp_path: Path) -> None:
    samples = sorted(SAMPLES.glob("schema_*.studio"))
    assert samples
    for sample in samples:
        shutil.copy(sample, tmp_path)
        opened = read_project(tmp_path / sample.name)
        assert opened.problems == ()
        assert len(opened.project.characters) == 2
        assert opened.project.constraints["constraint 0"].target == (0.4, -0.3, 1.2)
        assert all(clip.id for performer in opened.project.performers.values() for clip in performer.clips)
        assert opened.project.constraints["constraint 0"].scope == EVERYONE


def test_upgrades_go_step_by_step() -> None:
    steps = {1: lambda record: {**record, "a": 1}, 2: lambda record: {**record, "b": record["a"] + 1}}
    record = upgraded_record({"schema": 1}, "project.json", steps, 3)
    assert record == {"schema": 3, "a": 1, "b": 2}


@pytest.mark.parametrize("number", [b"1e999", b"NaN", b"-Infinity"])
def test_a_number_beyond_all_bounds_is_told(saved: Path, number: bytes) -> None:
    with zipfile.ZipFile(saved) as archive:
        content = archive.read("project.json").replace(b'"height":0.0', b'"height":' + number)
    with zipfile.ZipFile(saved, "w") as archive:
        archive.writestr("project.json", content)
    with pytest.raises(StudioError, match=r"project\.json"):
        read_project(saved)


def test_any_value_of_project_json_may_be_anything_and_nothing_falls_over(saved: Path) -> None:
    """100 files in which one value, somewhere, is something else; each opens with what makes sense."""
    chance, content = Random(9), saved.read_bytes()
    odd = [
        None,
        True,
        -1,
        10**400,
        1e308,
        -0.0,
        "",
        "x",
        [],
        {},
        [[]],
        {"member": "x"},
        [None] * 3,
        "\ud800",
        {"a": {}},
    ]

    def spoil(record: dict) -> None:
        place: dict | list = record
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            key = chance.choice(keys)
            if not isinstance(place[key], dict | list) or not place[key] or chance.random() < 0.15:
                place[key] = chance.choice(odd)
                return
            place = place[key]

    opened = 0
    for _ in range(100):
        saved.write_bytes(content)
        repacked(saved, spoil)
        try:
            read = read_project(saved)
        except StudioError:
            continue
        write_project(saved.with_name("again.studio"), read.project, ID)
        opened += 1
    assert opened > 66


def test_constraints_that_contradict_each_other_are_opened_whole_and_remarked_on(tmp_path):
    path = tmp_path / "rivals.studio"
    rival = make_constraint(name="Rival", target=(0.0, 0.0, 1.0))
    project = make_project(constraints=1).with_entity("constraints", "rival", rival)
    write_project(path, project, "document")
    opened = read_project(path)
    assert opened.project.constraints == project.constraints
    assert (opened.problems, opened.read_only) == ((), False)
    [remark] = opened.remarks
    assert remark.startswith("'Rival' conflicts with 'Target 0'")


def test_a_project_whose_ground_is_lost_stands_on_a_level_one():
    """A damaged file ended in a KeyError once its performers were adapted."""
    project = replace(make_project(), grounds={"elsewhere": Ground(0.5)})
    assert project.ground == Ground()
    assert project.grounds["elsewhere"] == Ground(0.5)
