"""S4D files nobody vetted: each is refused in a sentence that names the file. The list never shrinks."""

import io
import json
import struct
import zipfile

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.io.importing import load_capture
from studio.io.s4d.reader import read_s4d
from studio.io.s4d.writer import S4d, write_s4d
from tests.builders import make_capture
from tests.io.refused import refused

RECORD, CHANNELS = "s4d.json", "channels.npy"


@pytest.fixture(scope="module")
def members(tmp_path_factory):
    """The members of a right file."""
    path = tmp_path_factory.mktemp("s4d") / "right.s4d"
    capture = make_capture()
    write_s4d(path, S4d(capture, *normalize_capture(capture)))
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(members, method=zipfile.ZIP_DEFLATED):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


def npy(array, **options):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, **options)
    return stream.getvalue()


def with_record(members, change):
    record = json.loads(members[RECORD])
    change(record)
    return packed({**members, RECORD: json.dumps(record).encode()})


def with_actor(**values):
    return lambda members: with_record(members, lambda record: record["actor"].update(values))


def with_fields(**values):
    return lambda members: with_record(members, lambda record: record.update(values))


def with_text(find, put):
    return lambda members: packed({**members, RECORD: members[RECORD].replace(find, put, 1)})


def with_channels(change):
    """Channels that are what ``change`` makes of the right ones."""

    def broken(members):
        array = np.load(io.BytesIO(members[CHANNELS]))
        return packed({**members, CHANNELS: npy(change(array), allow_pickle=True)})

    return broken


def with_hole(array):
    array[3, 5] = np.nan
    return array


def without(name):
    return lambda members: packed({key: item for key, item in members.items() if key != name})


def lying_header(members):
    header = members[CHANNELS].replace(b"(30, 101)", b"(99, 101)")
    return packed({**members, CHANNELS: header})


def endless_shape(members):
    return packed({**members, CHANNELS: members[CHANNELS].replace(b"(30, 101), ", b"(9**9**9,), ")})


def zip_bomb(members):
    return packed({**members, CHANNELS: b"\0" * 120_000_000})


def many_joints(members):
    """Few bytes that unfold to millions of poses."""
    record = json.loads(members[RECORD])
    count, actor = 3000, record["actor"]
    actor["joints"] += [f"j{k}" for k in range(count)]
    actor["parents"] += [0] * count
    actor["offsets"] += [[0, 0, 0]] * count
    actor["reference_rotations"] += [[0, 0, 0, 1]] * count
    frames = np.zeros((20_000, 101), np.float32)
    return packed({**members, RECORD: json.dumps(record).encode(), CHANNELS: npy(frames)})


def directory_that_lies(members):
    """A member said to be shorter than it is."""
    content = packed(members, zipfile.ZIP_STORED)
    size = len(members[CHANNELS])
    return content.replace(struct.pack("<2L", size, size), struct.pack("<2L", size, size // 2))


def encrypted(members):
    content = bytearray(packed(members))
    at = content.index(b"PK\x01\x02")
    content[at + 8] |= 1
    return bytes(content)


def bad_byte(members):
    content = bytearray(packed(members, zipfile.ZIP_STORED))
    content[content.index(b"NUMPY") + 300] ^= 255
    return bytes(content)


LATE = {"left_heel": [[0, 30]]}
CASES = {
    "no bytes": (lambda members: b"", "is empty. Copy or export it again."),
    "cut off": (lambda members: packed(members)[:-100], "File is not a zip file"),
    "another file": (lambda members: b"PK\x03\x04" + b"x" * 500, "File is not a zip file"),
    "a byte changed": (bad_byte, "Bad CRC-32"),
    "encrypted": (encrypted, "is encrypted"),
    "zip bomb": (zip_bomb, "would unpack to .*, far more than it can hold"),
    "a size that lies": (directory_that_lies, "not a complete S4D file"),
    "few bytes of many poses": (many_joints, "more than a file of this size can hold"),
    "no record": (without(RECORD), "There is no item named 's4d.json'"),
    "no channels": (without(CHANNELS), "There is no item named 'channels.npy'"),
    "no rotations": (without("rotations.npy"), "There is no item named 'rotations.npy'"),
    "record that is no JSON": (with_text(b"{", b"["), "not readable as JSON"),
    "record cut off": (lambda members: packed({**members, RECORD: members[RECORD][:90]}), "not readable as JSON"),
    "record of another kind": (with_fields(format="S5D"), "does not say that it is one"),
    "record that is a list": (lambda members: packed({**members, RECORD: b"[1]"}), "does not say that it is one"),
    "record nested deeply": (lambda members: packed({**members, RECORD: b"[" * 99_999}), "not readable as JSON"),
    "newer version": (with_fields(version=2), "has version 2 of S4D. Install a newer"),
    "version that is no number": (with_fields(version="x" * 99), "has version x{20} of S4D"),
    "NaN in the record": (with_fields(frame_rate=float("nan")), "NaN is not a number"),
    "infinite number": (with_text(b'"frame_rate": 60.0', b'"frame_rate": 1e999'), "1e999 is out of range"),
    "frame rate zero": (with_fields(frame_rate=0.0), "at 0Hz are not a motion"),
    "frame rate in words": (with_fields(frame_rate="fast"), "frame_rate: a number expected"),
    "name missing": (lambda members: with_record(members, lambda r: r.pop("name")), "name missing"),
    "first frame after the last": (with_fields(first_frame=30), "has no frame 30; it ends at 29"),
    "spine that falls": (with_fields(spine_places=[0, 0.7, 0.4]), "spine_places rise from 0"),
    "spine of one segment": (with_fields(spine_places=[0]), "is too few|do not fit"),
    "contact after the end": (with_fields(contacts=LATE), "ends at frame 30, after the last, 29"),
    "contact of no foot": (with_fields(contacts={"nose": []}), "contacts, nose: expected lists"),
    "constraint of no kind": (with_fields(constraints=[{"kind": "magic"}]), "constraints.0., kind: expected one of"),
    "label backwards": (with_fields(labels=[{"name": "a", "first": 5, "last": 2}]), "labels: A label runs"),
    "parents that do not fit": (with_actor(parents=[-1]), "needs parents of shape|expected"),
    "parents in a ring": (with_actor(parents=[-1, 2, 1, *range(2, 25)]), "comes before its parent"),
    "joint twice": (with_actor(joints=["Hips"] * 26), "Two joints of the skeleton are called 'Hips'"),
    "offsets of wrong shape": (with_actor(offsets=[[0, 0, 0]]), r"offsets of shape \(26, 3\) expected"),
    "offset too large": (with_actor(offsets=[[1e9, 0, 0]] * 26), "offsets: a number is out of range"),
    "segments of no joint": (with_actor(segment_joints=[99] * 21), "segment_joints names a joint"),
    "too few segments": (with_actor(segment_joints=[0, 1, 2]), r"segment_joints of shape \(21,\) expected"),
    "pelvis without a joint": (with_actor(segment_joints=[-1] * 21), "the pelvis' joint must be there"),
    "alignment without length": (with_actor(alignments=[[0, 0, 0, 0]] * 21), "alignments"),
    "reference without length": (with_actor(reference_rotations=[[0, 0, 0, 0]] * 26), "reference_rotations are"),
    "morphology without a leg": (with_actor(morphology={}), "A morphology needs"),
    "joint of rotations twice": (with_actor(rotations_of=[1, 1]), "rotations_of names a joint twice"),
    "joint of rotations that is not there": (with_actor(rotations_of=[-1]), "rotations_of names a joint"),
    "rotations of a joint that are not there": (with_actor(rotations_of=[5]), r"rotations.npy of shape \(30, 1, 4\)"),
    "channels of objects": (with_channels(lambda a: a.astype(object)), "its numbers are .\\|O"),
    "channels of whole numbers": (with_channels(lambda a: a.astype(np.int32)), "its numbers are .<i4"),
    "channels of half precision": (with_channels(lambda a: a.astype(np.float16)), "its numbers are .<f2"),
    "channels of complex numbers": (with_channels(lambda a: a.astype(complex)), "its numbers are .<c16"),
    "channels with a hole": (with_channels(with_hole), "not finite or out of range"),
    "channels of two fields": (
        with_channels(lambda a: a.view([("x", "f4")])),
        "'channels.npy': it is not a plain array",
    ),
    "channels too large": (with_channels(lambda a: a * 1e9 + 1e9), "not finite or out of range"),
    "channels too few": (with_channels(lambda a: a[:, :-1]), "do not fit 3 spine segments"),
    "channels in one row": (with_channels(np.ravel), "do not fit 3 spine segments"),
    "channels without frames": (with_channels(lambda a: a[:0]), "0 frames at 60Hz are not a motion|expected"),
    "a header that lies": (lying_header, "its header does not fit its content"),
    "a shape without end": (endless_shape, "'channels.npy': it is not a plain array"),
    "an array that is none": (
        lambda members: packed({**members, CHANNELS: b"hello"}),
        "'channels.npy': it is not a plain array",
    ),
    "a limb of NaN in words": (with_text(b'"origin": [', b'"origin": [null, '), "origin"),
}


@pytest.mark.parametrize("case", CASES)
def test_it_is_refused_in_a_sentence(members, tmp_path, case):
    make, sentence = CASES[case]
    told = refused(load_capture, tmp_path / "take.s4d", make(members), sentence)
    assert told.startswith("take.s4d")
    assert told.endswith(".")


def test_the_right_file_is_read(members, tmp_path):
    (tmp_path / "take.s4d").write_bytes(packed(members))
    assert load_capture(tmp_path / "take.s4d").frame_count == 30


def test_float64_and_rows_first_are_read_as_well(members, tmp_path):
    (tmp_path / "take.s4d").write_bytes(with_channels(lambda a: np.ascontiguousarray(a, np.float64))(members))
    assert load_capture(tmp_path / "take.s4d").frame_count == 30


def test_annotations_are_checked_against_the_frames(members, tmp_path):
    (tmp_path / "take.s4d").write_bytes(with_fields(contacts=LATE)(members))
    with pytest.raises(StudioError, match="after the last"):
        read_s4d(tmp_path / "take.s4d", "motion")


def test_a_folder_and_a_missing_file_are_refused(tmp_path):
    for path in (tmp_path / "none.s4d", tmp_path):
        with pytest.raises(StudioError, match="could not be read"):
            load_capture(path)
