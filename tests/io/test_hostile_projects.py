"""Projects and characters nobody vetted: each named case is told in a sentence, and what is whole still opens.

The list never shrinks.
"""

import hashlib
import json
import re
import struct
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.io.project.character_file import read_character, write_character
from studio.io.project.project_file import document_id_of, read_project, write_project
from tests.builders import make_character, make_project
from tests.io.refused import refused

Record = dict[str, Any]
Change = Callable[[Record], object]


@pytest.fixture(scope="module")
def members(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    path = tmp_path_factory.mktemp("good") / "walk.studio"
    write_project(path, make_project(), "0" * 32)
    with zipfile.ZipFile(path) as archive:
        return {
            entry.filename: archive.read(entry) for entry in archive.infolist() if entry.filename != "manifest.json"
        }


def packed(members: dict[str, bytes]) -> bytes:
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return stream.getvalue()


def project(change: Change) -> Callable[[dict[str, bytes]], bytes]:
    """The good project with another project.json."""

    def spoil(members: dict[str, bytes]) -> bytes:
        record = json.loads(members["project.json"])
        change(record)
        return packed({**members, "project.json": json.dumps(record).encode()})

    return spoil


def text(content: bytes) -> Callable[[dict[str, bytes]], bytes]:
    return lambda members: packed({**members, "project.json": content})


def array(content: bytes) -> Callable[[dict[str, bytes]], bytes]:
    """Another content, under its right name, for the turns of the joints."""
    name = f"captures/{hashlib.sha256(content).hexdigest()}.npy"

    def spoil(members: dict[str, bytes]) -> bytes:
        record = json.loads(members["project.json"])
        record["captures"][0]["poses"]["local_rotations"] = {"member": name}
        return packed({**members, "project.json": json.dumps(record).encode(), name: content})

    return spoil


def npy(value: np.ndarray, **options: Any) -> bytes:
    stream = BytesIO()
    np.save(stream, value, **options)
    return stream.getvalue()


def repacked_and_damaged(method: int) -> Callable[[dict[str, bytes]], bytes]:
    """As another program packs it, with its first member spoilt."""

    def spoil(members: dict[str, bytes]) -> bytes:
        stream = BytesIO()
        with zipfile.ZipFile(stream, "w", method) as archive:
            for name, content in members.items():
                archive.writestr(name, content)
        content = bytearray(stream.getvalue())
        content[60:400:7] = bytes(byte ^ 0x5A for byte in content[60:400:7])
        return bytes(content)

    return spoil


def headers_that_claim_all(members: dict[str, bytes]) -> bytes:
    """A hundred thousand packed members, each as long as all that follows."""
    head = struct.pack("<4s5H3I2H", b"PK\3\4", 20, 0, 8, 0, 0, 0, 3_000_000, 3_000_000, 0, 0)
    return head * 100_000


def directory_before_the_file(members: dict[str, bytes]) -> bytes:
    """Found by the soak: places in the directory that lie before the first byte."""
    content = bytearray(packed(members))
    end = content.rindex(b"PK\x05\x06")
    content[end + 16 : end + 20] = (len(content)).to_bytes(4, "little")
    return bytes(content)


def entity(collection: str, **values: Any) -> Callable[[dict[str, bytes]], bytes]:
    return project(lambda record: record[collection][0].update(values))


def inside(collection: str, member: str, **values: Any) -> Callable[[dict[str, bytes]], bytes]:
    return project(lambda record: record[collection][0][member].update(values))


def behaviour(**values: object) -> Callable[[dict[str, bytes]], bytes]:
    """A behaviour of one state, with something wrong in it."""
    record = {"id": "fighter", "name": "Fighter", "states": [{"name": "Guard"}], **values}
    return project(lambda given: given["behaviours"].append(record))


REFUSED: dict[str, tuple[Callable[[dict[str, bytes]], bytes], str]] = {
    "an empty file": (lambda _: b"", "is empty"),
    "a text": (lambda _: b"Dear diary\n" * 40, "not a ZIP archive"),
    "an archive cut in its first member": (lambda members: packed(members)[:60], "damaged"),
    "an archive without a project": (lambda _: packed({"readme.txt": b"hello"}), "'project.json' in .* is missing"),
    "an archive of nothing": (lambda _: packed({}), "not a ZIP archive"),
    "an archive of headers": (headers_that_claim_all, "not a ZIP archive"),
    "an archive deflated and damaged": (repacked_and_damaged(zipfile.ZIP_DEFLATED), "not a ZIP archive"),
    "an archive of bzip2, damaged": (repacked_and_damaged(zipfile.ZIP_BZIP2), "not a ZIP archive"),
    "an archive of LZMA, damaged": (repacked_and_damaged(zipfile.ZIP_LZMA), "not a ZIP archive"),
    "project.json is empty": (text(b""), "project.json"),
    "project.json is binary": (text(b"\x80\x81\xff"), "project.json"),
    "project.json is cut off": (text(b'{"schema": 1, "captures": ['), "project.json"),
    "project.json is a list": (text(b"[1, 2]"), "project.json"),
    "project.json is nested ten thousand deep": (text(b'{"a":' * 10_000), "project.json"),
    "project.json has no schema": (project(lambda record: record.pop("schema")), "does not say which version"),
    "the schema is a word": (project(lambda record: record.update(schema="one")), "does not say which version"),
    "the schema is zero": (project(lambda record: record.update(schema=0)), "does not say which version"),
    "a frame rate out of range": (
        lambda members: packed(
            {**members, "project.json": members["project.json"].replace(b'"frame_rate":60.0', b'"frame_rate":1e999')}
        ),
        "1e999 is out of range",
    ),
    "the schema is not finite": (text(b'{"schema": 1e999}'), "project.json"),
}

TOLD: dict[str, tuple[Callable[[dict[str, bytes]], bytes], str]] = {
    "a directory that points before the file": (directory_before_the_file, "walk.studio"),
    "a member named twice in an id": (
        project(lambda record: record["props"].extend([{"id": "a", "name": "A"}, {"id": "a", "name": "B"}])),
        "props",
    ),
    "a schema of the future": (project(lambda record: record.update(schema=99)), "newer version"),
    "an entity without an id": (project(lambda record: record["motions"][0].pop("id")), "motions"),
    "an id that is a number": (entity("motions", id=7), "motions"),
    "an entity that is a number": (project(lambda record: record["contacts"].append(4)), "contacts"),
    "a collection that is a word": (project(lambda record: record.update(contacts="none")), "contacts"),
    "an array that is pickled": (array(npy(np.array([{}], dtype=object), allow_pickle=True)), "is not an array"),
    "an array of words": (array(npy(np.array(["x"]))), "captures, 'walk': poses"),
    "an array of no dimensions": (array(npy(np.array(1.0))), "captures, 'walk': poses"),
    "an array cut off": (array(npy(np.zeros((30, 26, 4)))[:200]), "is not an array"),
    "an array whose header promises terabytes": (
        array(npy(np.zeros(2)).replace(b"(2,), }         ", b"(9999999999,), }")),
        "is not an array",
    ),
    "an array that is no array": (array(b"hello"), "is not an array"),
    "an array beside the archive": (
        inside("captures", "poses", local_rotations={"member": "../../etc/passwd"}),
        "not the name of a member",
    ),
    "an array that is not there": (
        inside("captures", "poses", local_rotations={"member": f"captures/{'0' * 64}.npy"}),
        "missing or damaged",
    ),
    "a capture without frames": (inside("captures", "poses", local_rotations=[], local_translations=[]), "capture"),
    "a capture with other joints than its poses": (inside("captures", "skeleton", names=["one"]), "capture"),
    "a joint that hangs from itself": (inside("captures", "skeleton", parents=[0] * 26), "capture"),
    "a frame rate of zero": (entity("captures", frame_rate=0), "frame rate"),
    "a first frame after the last": (entity("captures", first_frame=9999), "no frame 9999"),
    "a body map with a joint that is not there": (
        inside("captures", "body_map", spine=[0, 99]),
        "names a joint that its skeleton does not have",
    ),
    "a clip of a motion that is not there": (
        entity("performers", clips=[{"motion_id": "gone", "first": 0, "last": 3, "start": 0.0}]),
        "it needs motions that could not be read",
    ),
    "a performer without a character": (entity("performers", character_id="nobody"), "it needs characters"),
    "a contact that ends before it begins": (entity("contacts", first=9, last=2), "from a frame to a later one"),
    "a contact at a point that no body has": (entity("contacts", point="left_fin"), "left_fin"),
    "a constraint with a target of two numbers": (entity("constraints", target=[1, 2]), "target"),
    "a constraint whose times run backwards": (inside("constraints", "activation", start=3.0), "activation"),
    "a constraint with a weight of seven": (inside("constraints", "chain", limb=7.0), "limb is 7"),
    "a character as tall as a house": (inside("characters", "proportions", stature=900), "between"),
    "a character of another colour": (entity("characters", colour="blue"), "#RRGGBB"),
    "a character without legs": (project(lambda record: record["characters"][0]["build"].pop("leg")), "leg"),
    "a character with a negative thigh": (inside("characters", "build", leg=[[-1, 1], [1, 1]]), "length above zero"),
    "a vertex beyond single precision": (inside("characters", "skin", vertices=[[1e300, 0, 0]]), "numbers|skin"),
    "a behaviour without states": (behaviour(states=[]), "needs at least one state"),
    "a behaviour that begins nowhere": (behaviour(start="Nap"), "does not exist"),
    "a transition to no state": (
        behaviour(transitions=[{"source": "Guard", "target": "Nap", "conditions": [{"kind": "clip_end"}]}]),
        "refers to a missing state, 'Nap'",
    ),
    "a transition that waits for nothing": (
        behaviour(transitions=[{"source": "Guard", "target": "Guard", "conditions": []}]),
        "needs a condition",
    ),
    "a state as far away as the moon": (
        behaviour(states=[{"name": "Guard", "manners": [{"kind": "keep_distance", "distance": 4e8}]}]),
        "is out of range",
    ),
    "a behaviour of a body that is not there": (behaviour(cast=[{"performer_id": "gone"}]), "it needs performers"),
    "a state that is a number": (behaviour(states=[7]), "a record expected"),
    "a ground with the height of nothing": (entity("grounds", height=None), "ground"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_bad_project_is_refused_in_a_sentence(members: dict[str, bytes], tmp_path: Path, case: str) -> None:
    spoil, words = REFUSED[case]
    assert "walk.studio" in refused(read_project, tmp_path / "walk.studio", spoil(members), words)


@pytest.mark.parametrize("case", TOLD)
def test_what_is_wrong_in_a_project_is_told_and_the_rest_opens(
    members: dict[str, bytes], tmp_path: Path, case: str
) -> None:
    spoil, words = TOLD[case]
    path = tmp_path / "walk.studio"
    path.write_bytes(spoil(members))
    opened = read_project(path)
    assert re.search(words, " ".join(opened.problems)), opened.problems
    assert opened.project.ground is not None


def test_a_project_without_a_ground_stands_on_a_flat_one(members: dict[str, bytes], tmp_path: Path) -> None:
    (tmp_path / "walk.studio").write_bytes(project(lambda record: record.update(grounds=[]))(members))
    assert read_project(tmp_path / "walk.studio").project.ground.height == 0.0


def test_what_is_of_a_kind_that_is_not_known_here_is_kept_for_the_version_that_knows_it(
    members: dict[str, bytes], tmp_path: Path
) -> None:
    (tmp_path / "walk.studio").write_bytes(entity("constraints", kind="magnet")(members))
    opened = read_project(tmp_path / "walk.studio")
    assert not opened.project.constraints
    write_project(tmp_path / "again.studio", opened.project, opened.document_id)
    with zipfile.ZipFile(tmp_path / "again.studio") as archive:
        assert b'"magnet"' in archive.read("project.json")


def skin(**arrays: np.ndarray | None) -> Change:
    """Another mesh, under its right hash."""

    def spoil(record: Record) -> None:
        stream, path = BytesIO(), Path(record.pop("path"))
        with np.load(path) as good:
            members = {**good, **arrays}
        np.savez(stream, **{name: value for name, value in members.items() if value is not None})
        path.write_bytes(stream.getvalue())
        record["sha256"] = hashlib.sha256(stream.getvalue()).hexdigest()

    return spoil


def build(**values: Any) -> Change:
    return lambda record: record["build"].update(values)


CHARACTERS: dict[str, tuple[Change, str]] = {
    "another format": (lambda record: record.update(format="somebody else's"), "'format' is not"),
    "a version of the future": (lambda record: record.update(version=99), "version 99 is not known here"),
    "no version": (lambda record: record.pop("version"), "version None"),
    "no name": (lambda record: record.pop("name"), "'name' is missing"),
    "a name that is a list": (lambda record: record.update(name=["Tom"]), "'name' is missing or of the wrong kind"),
    "a colour in words": (lambda record: record.update(colour="blue"), "#RRGGBB expected"),
    "a colour with letters that are no digits": (lambda record: record.update(colour="#GG0000"), "#RRGGBB expected"),
    "a colour that is a number": (lambda record: record.update(colour=7), "'colour' is missing"),
    "a mesh in another folder": (lambda record: record.update(mesh="../../etc/passwd"), "its folder"),
    "a mesh under an absolute path": (lambda record: record.update(mesh="/etc/passwd"), "its folder"),
    "a mesh that is not there": (lambda record: record.update(mesh="gone.npz"), "gone.npz could not be read"),
    "another hash": (lambda record: record.update(sha256="0" * 64), "not the mesh"),
    "no build": (lambda record: record.pop("build"), "'build' is missing"),
    "a build without legs": (lambda record: record["build"].pop("leg"), "leg"),
    "a bone without length": (build(arm=[[0.0, 0.3], [0.3, 0.3]]), "length above zero"),
    "a bone that is not a number": (build(neck="long"), "damaged"),
    "a bone of infinite length": (build(neck=1e999), "damaged"),
    "one leg": (build(leg=[[0.4, 0.4]]), "damaged"),
    "a spine of one vertebra": (build(spine=[[0.0, 0.0, 0.2]]), "damaged"),
    "a proportion that is not known": (lambda record: record.update(proportions={"wings": 2}), "damaged"),
    "a proportion out of range": (lambda record: record.update(proportions={"stature": 1e9}), "between"),
    "a build of nothing": (lambda record: record.update(build={}), "needs spine"),
    "a proportion below zero": (lambda record: record.update(proportions={"head": -1.0}), "between 0.2 and 5"),
    "a proportion that is a word": (lambda record: record.update(proportions={"stature": "tall"}), "damaged"),
    "proportions in a list": (lambda record: record.update(proportions=[1]), "damaged"),
    "a mesh without vertices": (skin(vertices=None), "mesh is damaged"),
    "a mesh with one vertex": (skin(vertices=np.zeros((1, 3), np.float32)), "mesh is damaged"),
    "a vertex that is not finite": (skin(vertices=np.full((12, 3), np.nan, np.float32)), "mesh is damaged"),
    "a triangle of a vertex that is not there": (skin(triangles=np.full((1, 3), 99, np.int32)), "mesh is damaged"),
    "a segment that the body has not": (skin(segments=np.full((12, 4), 99, np.int32)), "segment"),
    "a segment below zero": (skin(segments=np.full((12, 4), -1, np.int32)), "segment|mesh is damaged"),
    "weights of words": (skin(weights=np.full((12, 4), "x")), "mesh is damaged"),
    "weights that do not sum to one": (skin(weights=np.full((12, 4), 9.0, np.float32)), "mesh is damaged"),
    "a mesh of pickled objects": (skin(weights=np.array([{}] * 48, dtype=object).reshape(12, 4)), "mesh is damaged"),
}


@pytest.mark.parametrize("case", CHARACTERS)
def test_a_bad_character_is_refused_in_a_sentence(tmp_path: Path, case: str) -> None:
    change, words = CHARACTERS[case]
    path = tmp_path / "dancer.json"
    write_character(make_character(), path)
    record = {**json.loads(path.read_text()), "path": str(path.with_suffix(".npz"))}
    change(record)
    record.pop("path", None)
    refused(read_character, path, json.dumps(record), words)


@pytest.mark.parametrize("name", ["../../elsewhere", "/tmp/x", "a\0b", "", 7, "x" * 5000])
def test_an_id_that_would_name_a_file_elsewhere_is_not_believed(tmp_path: Path, name: object) -> None:
    path = tmp_path / "walk.studio"
    write_project(path, make_project(), "0" * 32)
    with zipfile.ZipFile(path) as archive:
        found = {entry.filename: archive.read(entry) for entry in archive.infolist()}
    manifest = json.loads(found["manifest.json"])
    path.write_bytes(packed({**found, "manifest.json": json.dumps({**manifest, "document": name}).encode()}))
    assert re.fullmatch("[0-9a-f]{32}", read_project(path).document_id)
    assert document_id_of(path) is None


def test_a_project_that_unpacks_a_thousandfold_is_refused_before_it_is_unpacked(
    members: dict[str, bytes], tmp_path: Path
) -> None:
    path = tmp_path / "walk.studio"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in {**members, "captures/zeros.npy": bytes(150_000_000)}.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    assert path.stat().st_size < 2_000_000
    with pytest.raises(StudioError, match=r"walk\.studio' would unpack to more than 1\d\d MB"):
        read_project(path)
