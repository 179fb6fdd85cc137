"""Mutated files of every kind: described or refused in a sentence, and never anything else. Seeded."""

import hashlib
import json
import re
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest

from studio.cli.info import file_record, lines_of
from studio.io.export import write_capture
from studio.io.importing import GUESS_ALL
from studio.io.project.project_file import write_project
from studio.resources_folder import resources_folder
from tests.builders import make_capture, make_project

WORDS = [b"{", b"}", b"\n", b" ", b"-", b"nan", b"NaN", b"\0", b"MOTION", b"\xff", b",", b"null", b'"x"', b"[]"]
NUMBERS = [b"0", b"-1", b"1e9", b"1e-9", b"1e400", b"99999999999", b"-1e12", b"1e-300", b"7", b"3.5"]
NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
NEAR_THE_START = 9000  # where headers are; a change among thousands of rows says little


def bytes_changed(random: Random, content: bytes) -> bytes:
    """Cut off, or with a few places overwritten, repeated or removed."""
    if random.random() < 0.15:
        return content[: random.randrange(len(content))]
    changed = bytearray(content)
    for _ in range(random.choice([1, 1, 2, 3, 8])):
        at = random.randrange(min(len(changed), NEAR_THE_START) or 1)
        match random.randrange(3):
            case 0:
                changed[at : at + random.randint(0, 12)] = random.choice(WORDS + NUMBERS)
            case 1:
                changed[at:at] = changed[at // 2 : at // 2 + random.randint(1, 200)]
            case 2:
                del changed[at : at + random.randint(1, 400)]
    return bytes(changed)


def numbers_changed(random: Random, content: bytes) -> bytes:
    """With some numbers, mostly early ones, being other numbers."""
    spots = [found.span() for found in NUMBER.finditer(content)][: 300 if random.random() < 0.7 else None]
    for first, last in sorted(random.sample(spots, min(len(spots), random.choice([1, 1, 3, 20]))), reverse=True):
        content = content[:first] + random.choice(NUMBERS) + content[last:]
    return content


def mutations(content: bytes, count: int) -> Iterator[bytes]:
    for seed in range(count):
        random = Random(seed)
        yield (bytes_changed if random.random() < 0.6 else numbers_changed)(random, content)


def look_at(path: Path) -> bool:
    """True if ``info`` could read it; its answer can be printed in either case."""
    record = file_record(path, GUESS_ALL)
    assert json.dumps(record, allow_nan=False)
    assert lines_of(record)
    assert record["ok"] or path.name in record["error"] or path.with_suffix(".npz").name in record["error"]
    return bool(record["ok"])


def survive(path: Path, content: bytes, count: int, write: Callable[[bytes], object] | None = None) -> None:
    opened = 0
    for changed in mutations(content, count):
        (write or path.write_bytes)(changed)
        opened += look_at(path)
    assert 0 < opened < count


@pytest.mark.parametrize("name", ["geno_bind_6ch", "pybvh_test2_yxz", "accad_male2_E21_DuckLeft"])
def test_a_mutated_capture_is_described_or_refused(captures: Path, tmp_path: Path, name: str) -> None:
    [original] = (captures / "bvh").rglob(f"{name}.bvh")
    survive(tmp_path / "take.bvh", original.read_bytes(), 60)


def test_a_mutated_s4d_is_described_or_refused(tmp_path: Path) -> None:
    """Stored members, so that changes reach numbers and record; the sums are put right again."""
    path = tmp_path / "walk.s4d"
    write_capture(make_capture(frames=12), path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    for name in members:
        for changed in mutations(members[name], 25):
            with zipfile.ZipFile(path, "w") as archive:
                for each, content in members.items():
                    archive.writestr(each, changed if each == name else content)
            look_at(path)
    write_capture(make_capture(frames=12), path)
    for changed in mutations(path.read_bytes(), 40):
        path.write_bytes(changed)
        look_at(path)


def test_a_mutated_project_is_described_or_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    write_project(path, make_project(), "0" * 32)
    survive(path, path.read_bytes(), 60)


def test_a_mutated_character_is_described_or_refused(tmp_path: Path) -> None:
    folder = resources_folder() / "characters"
    (tmp_path / "child.npz").write_bytes((folder / "child.npz").read_bytes())
    survive(tmp_path / "child.json", (folder / "child.json").read_bytes(), 100)


def test_a_mutated_mesh_is_described_or_refused(tmp_path: Path) -> None:
    folder = resources_folder() / "characters"
    record = json.loads((folder / "child.json").read_bytes())

    def write(mesh: bytes) -> None:
        """Under a right hash, so that the mesh itself is looked at."""
        (tmp_path / "child.npz").write_bytes(mesh)
        (tmp_path / "child.json").write_text(json.dumps({**record, "sha256": hashlib.sha256(mesh).hexdigest()}))

    path = tmp_path / "child.json"
    for changed in mutations((folder / "child.npz").read_bytes(), 150):
        write(changed)
        look_at(path)


@pytest.mark.parametrize("end_of_the_short_bone", ["LeftArm", "Head"])
def test_a_neck_or_clavicle_without_length_comes_back_as_it_was(
    captures: Path, tmp_path: Path, end_of_the_short_bone: str
) -> None:
    """Found by the fuzzing: a bone that points nowhere had no place at rest."""
    [original] = (captures / "bvh").rglob("accad_male2_E21_DuckLeft.bvh")
    joint = rf"(JOINT {end_of_the_short_bone}\s*{{\s*OFFSET)[^\n]*"
    text, changes = re.subn(joint, r"\1 0 0 0", original.read_text())
    (tmp_path / "take.bvh").write_text(text)
    record = file_record(tmp_path / "take.bvh", GUESS_ALL)
    assert changes == 1
    assert record["ok"], record["error"]
    assert record["round_trip"]["position_mm"] < 0.1
