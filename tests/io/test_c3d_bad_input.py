"""C3D files nobody vetted: each case is repaired and listed, or refused in a sentence with file and byte.

The list never shrinks.
"""

import json
import random
import re
import struct
import tracemalloc
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.cli.info import file_record, lines_of
from studio.core.errors import StudioError
from studio.io.c3d.reader import C3dFile, read_c3d
from studio.io.c3d.writer import c3d_bytes
from studio.io.importing import GUESS_ALL, load_capture
from tests.io.c3d_hostile import (
    GOOD,
    Spoil,
    both,
    byte,
    cut,
    data_start,
    deeper,
    header,
    parameter,
    point,
    record_of,
    renamed,
    spoiled,
    step,
    value_of,
)
from tests.io.refused import refused
from tests.io.trials import make_trial, same

START = data_start(GOOD)
A_FRAME = 4 * (4 * 4 + 24)


def _read(tmp_path: Path, content: bytes) -> C3dFile:
    path = tmp_path / "take.c3d"
    path.write_bytes(content)
    return read_c3d(path)


REFUSED: dict[str, tuple[Spoil, str]] = {
    "empty": (cut(0), "take.c3d is empty."),
    "cut in the header": (cut(100), "take.c3d, byte 100: the file ends within its header."),
    "cut behind the header": (cut(512), "take.c3d, byte 0: its parameters should begin in block 2, which is not"),
    "cut in the parameters": (cut(700), "take.c3d, byte 694: the file ends within its parameters. It is cut off"),
    "cut before the first frame": (cut(START), "take.c3d, byte 16: its frames should begin in block"),
    "cut in the first frame": (cut(START + 40), f"take.c3d, byte {START}: there is no complete frame in this file"),
    "another format": (lambda _: b"HIERARCHY\n" * 100, "take.c3d, byte 1: a C3D file has 80 here, this one has 73."),
    "zeros": (lambda _: bytes(4096), "take.c3d, byte 1: a C3D file has 80 here, this one has 0."),
    "parameters in block 0": (byte(0, 0), "take.c3d, byte 0: its parameters should begin in block 0"),
    "parameters over the header": (byte(0, 1), "take.c3d, byte 0: its parameters should begin in block 1"),
    "parameters beyond the file": (byte(0, 255), "take.c3d, byte 0: its parameters should begin in block 255"),
    "unknown processor": (byte(515, 99), "take.c3d, byte 515: 99 is not a kind of processor; C3D knows 84 (Intel)"),
    "no processor": (byte(515, 0), "take.c3d, byte 515: 0 is not a kind of processor"),
    "frames in block 0 and no parameter": (
        both(header(8, 0), renamed("POINT", "DATA_START")),
        "take.c3d, byte 16: its frames should begin in block 0, which is not in the file",
    ),
    "frames beyond the file and no parameter": (
        both(header(8, 60000), renamed("POINT", "DATA_START")),
        "take.c3d, byte 16: its frames should begin in block 60000",
    ),
    "no points and no signals": (
        both(header(1, 0), header(2, 0)),
        "take.c3d, byte 2: the file holds no points, nor any",
    ),
    "more points than bytes": (header(1, 65535), "there is no complete frame in this file, though it says 12."),
    "more signals than bytes": (header(2, 65532), "there is no complete frame in this file, though it says 12."),
    "half a signal": (header(2, 23), "take.c3d, byte 4: 23 analog numbers a frame are not a whole multiple of 4"),
    "no frames": (
        both(
            *(header(3, 5), header(4, 4)),
            *(renamed("TRIAL", "ACTUAL_START_FIELD"), renamed("POINT", "FRAMES"), renamed("POINT", "LONG_FRAMES")),
        ),
        "there is no complete frame in this file, though it says 0.",
    ),
    "scale nan without a parameter": (
        both(header(6, float("nan")), renamed("POINT", "SCALE")),
        "take.c3d, byte 12: the scale of its points, nan, is not valid.",
    ),
    "scale zero without a parameter": (
        both(header(6, 0.0), renamed("POINT", "SCALE")),
        "take.c3d, byte 12: the scale of its points, 0, is not valid.",
    ),
    "scale beyond all bounds": (
        both(header(6, 1e30), parameter("POINT", "SCALE", struct.pack("<f", -1e30))),
        "take.c3d, byte 12: the scale of its points, 1e+30, is not valid.",
    ),
    "a parameter that leads into itself": (
        step("POINT", "RATE", 2),
        f"take.c3d, byte {record_of(GOOD, 'POINT', 'RATE')}: parameter 'RATE' is part of a loop.",
    ),
    "a name longer than the file": (
        lambda content: content[: value_of(content, "MANUFACTURER", "SOFTWARE") - 6],
        "the file ends within its parameters. It is cut off; export it again.",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused_in_a_sentence(tmp_path: Path, case: str) -> None:
    spoil, sentence = REFUSED[case]
    told = refused(read_c3d, tmp_path / "take.c3d", spoiled(spoil), re.escape(sentence))
    assert told.startswith("take.c3d")
    assert told.endswith(".")


REPAIRED: dict[str, tuple[Spoil, str]] = {
    "cut in a frame": (cut(START + 5 * A_FRAME + 7), "the file says 12 frames, but holds 5; it is cut off."),
    "more frames than bytes": (
        both(header(4, 60000), renamed("TRIAL", "ACTUAL_END_FIELD"), renamed("POINT", "LONG_FRAMES")),
        "says 59994 frames, but holds",
    ),
    "frames that differ": (
        parameter("POINT", "FRAMES", struct.pack("<H", 9)),
        "the file says 12 frames and in another place 9; read: 12.",
    ),
    "an end of the trial beyond the file": (
        parameter("TRIAL", "ACTUAL_END_FIELD", struct.pack("<HH", 18, 9000), skip=3),
        "says 589824012 frames, but holds",
    ),
    "an end of the trial before the last frame": (
        parameter("TRIAL", "ACTUAL_END_FIELD", struct.pack("<HH", 7, 0), skip=3),
        "the file says 12 frames and in another place 1; read: 12.",
    ),
    "points that differ": (
        parameter("POINT", "USED", struct.pack("<H", 200)),
        "take.c3d, byte 2: the header says 4 points, POINT:USED 200; read as the header says.",
    ),
    "signals that differ": (
        parameter("ANALOG", "USED", struct.pack("<H", 3)),
        "take.c3d, byte 4: the header says 6 analog channels, ANALOG:USED 3; read so.",
    ),
    "frames in no block": (header(8, 0), "take.c3d, byte 16: block 0 cannot hold the frames; POINT:DATA_START was"),
    "frame rate nan": (header(10, float("nan")), "take.c3d, byte 20: the frame rate nan is not valid; POINT:RATE"),
    "frame rate zero": (header(10, 0.0), "the frame rate 0 is not valid; POINT:RATE was taken."),
    "frame rate negative": (header(10, -50.0), "the frame rate -50 is not valid; POINT:RATE was taken."),
    "frame rates that differ": (
        header(10, 200.0),
        "take.c3d, byte 20: the header says 200 Hz, POINT:RATE 100; read as the header says.",
    ),
    "no frame rate at all": (
        both(header(10, float("inf")), renamed("POINT", "RATE")),
        "the frame rate inf is not valid; 100 Hz was taken.",
    ),
    "scale zero": (header(6, 0.0), "take.c3d, byte 12: the scale 0 is not valid; POINT:SCALE -1 was taken."),
    "scale nan": (header(6, float("nan")), "the scale nan is not valid; POINT:SCALE -1 was taken."),
    "scales of integers that differ": (
        both(header(6, 0.5), parameter("POINT", "SCALE", struct.pack("<f", 0.25))),
        "take.c3d, byte 12: the header says a scale of 0.5, POINT:SCALE 0.25; read as the header says.",
    ),
    "a point that is not a number": (
        point(2, 0, 1, float("nan")),
        "take.c3d: 1 unbelievable place made a gap, the first of point 1 in frame 2.",
    ),
    "a point at infinity": (
        point(2, 0, 1, float("-inf")),
        "1 unbelievable place made a gap, the first of point 1 in frame 2.",
    ),
    "a point beyond the moon": (
        point(0, 3, 2, 3e38),
        "1 unbelievable place made a gap, the first of point 4 in frame 0.",
    ),
    "signals that are not numbers": (point(1, 4, 0, float("nan")), "take.c3d: made 0, as not finite: 1 analog number."),
    "signals scaled beyond all bounds": (
        parameter("ANALOG", "GEN_SCALE", struct.pack("<f", 3e38)),
        "take.c3d: made 0, as not finite: ",
    ),
    "an unknown unit": (parameter("POINT", "UNITS", b"xy", skip=3), "POINT:UNITS is 'xy', which is not a known unit"),
    "labels twice": (
        lambda content: content.replace(b"RASI", b"LASI"),
        "take.c3d: 1 label repeated (LASI); numbers were added.",
    ),
    "no labels": (renamed("POINT", "LABELS"), "take.c3d: 4 points and 0 labels; the others were numbered."),
    "fewer labels than points": (
        parameter("POINT", "LABELS", bytes([2]), skip=3),
        "take.c3d: 4 points and 2 labels; the others were numbered.",
    ),
    "labels larger than their record": (
        parameter("POINT", "LABELS", bytes([255, 255]), skip=2),
        f"take.c3d, byte {value_of(GOOD, 'POINT', 'LABELS')}: parameter 'LABELS' does not fit into the bytes it has",
    ),
    "a parameter of no known type": (
        parameter("POINT", "LABELS", bytes([7]), skip=0),
        "parameter 'LABELS' does not fit into the bytes it has and was left out.",
    ),
    "a parameter of 200 dimensions": (
        parameter("POINT", "LABELS", bytes([200]), skip=1),
        "parameter 'LABELS' does not fit into the bytes it has and was left out.",
    ),
    "a plate without corners": (
        renamed("FORCE_PLATFORM", "CORNERS"),
        "take.c3d: force plate 1 is not described completely; its signals are kept as such.",
    ),
    "a plate of no known kind": (
        parameter("FORCE_PLATFORM", "TYPE", struct.pack("<H", 77), skip=3),
        "force plate 1 is not described completely",
    ),
    "a plate fed by channels that are not there": (
        parameter("FORCE_PLATFORM", "CHANNEL", struct.pack("<HHHHHH", *range(500, 506)), skip=4),
        "force plate 1 is not described completely",
    ),
    "32000 plates": (
        parameter("FORCE_PLATFORM", "USED", struct.pack("<H", 32000)),
        "force plate 32 is not described completely",
    ),
    "more events than there are": (
        parameter("EVENT", "USED", struct.pack("<H", 5000)),
        "EVENT:USED is 5000, but only 2 events have a label and a time.",
    ),
    "events without times": (renamed("EVENT", "TIMES"), "EVENT:USED is 2, but only 0 events have a label and a time."),
    "signals without samples a frame": (header(9, 0), "take.c3d, byte 18: the file says 0 analog samples a frame"),
}


@pytest.mark.parametrize("case", REPAIRED)
def test_it_is_repaired_and_listed(tmp_path: Path, case: str) -> None:
    spoil, repair = REPAIRED[case]
    file = _read(tmp_path, spoiled(spoil))
    assert any(repair in listed for listed in file.repairs), file.repairs
    assert file.trial.frame_count >= 1


HARMLESS: dict[str, Spoil] = {
    "an event at no time": parameter("EVENT", "TIMES", struct.pack("<f", float("nan")), skip=4),
    "a step of zero ends the parameters": step("MANUFACTURER", "SOFTWARE", 0),
    "labels that are no text": lambda content: content.replace(b"RASI", b"\xff\x00\xfe\x01"),
    "a residual beyond all bounds": point(0, 0, 3, 3e38),
    "a residual that is not a number": point(0, 0, 3, float("nan")),
    "more blocks of parameters than there are": byte(514, 255),
    "bytes behind the end": lambda content: content + b"\xff" * 333,
    "a first frame of 65535": header(3, 65535),
}


@pytest.mark.parametrize("case", HARMLESS)
def test_it_is_read_all_the_same(tmp_path: Path, case: str) -> None:
    assert _read(tmp_path, spoiled(HARMLESS[case])).trial.frame_count == 12


@pytest.mark.parametrize(
    ("group", "name"),
    [
        ("TRIAL", "ACTUAL_START_FIELD"), ("TRIAL", "ACTUAL_END_FIELD"), ("POINT", "LABELS"), ("POINT", "RATE"),
        ("ANALOG", "SCALE"), ("EVENT", "TIMES"), ("EVENT", "LABELS"), ("FORCE_PLATFORM", "CORNERS"),
        ("FORCE_PLATFORM", "ORIGIN"), ("FORCE_PLATFORM", "CHANNEL"), ("FORCE_PLATFORM", "TYPE"),
    ],
)  # fmt: skip
def test_a_further_dimension_of_a_parameter_changes_nothing(tmp_path: Path, group: str, name: str) -> None:
    plain, deep = _read(tmp_path, GOOD), _read(tmp_path, spoiled(deeper(group, name)))
    assert same(deep.trial, plain.trial)
    assert deep.repairs == plain.repairs


def test_fields_of_the_trial_that_are_negative_say_nothing(tmp_path: Path) -> None:
    fields = ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD")
    unset = [parameter("TRIAL", name, struct.pack("<hh", -1, -1), skip=3) for name in fields]
    assert same(_read(tmp_path, spoiled(both(*unset))).trial, _read(tmp_path, GOOD).trial)


def test_nothing_is_allocated_that_only_a_header_promises(tmp_path: Path) -> None:
    """Headers that ask for terabytes cost no more than a few times the file."""
    path = tmp_path / "take.c3d"
    for spoil in (
        parameter("TRIAL", "ACTUAL_END_FIELD", struct.pack("<HH", 65535, 65535), skip=3),
        header(1, 65535),
        parameter("POINT", "LABELS", bytes([255, 255]), skip=2),
        both(header(4, 65535), parameter("POINT", "LONG_FRAMES", struct.pack("<f", 2e9))),
    ):
        path.write_bytes(spoiled(spoil))
        tracemalloc.start()
        file_record(path, GUESS_ALL)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert most < 20 * len(GOOD) + 5_000_000


@pytest.mark.parametrize("length", range(0, len(GOOD), 97))
def test_a_file_cut_anywhere_opens_with_whole_frames_or_is_refused_with_its_byte(tmp_path: Path, length: int) -> None:
    if length < START + A_FRAME:
        with pytest.raises(StudioError, match=r"^take\.c3d"):
            _read(tmp_path, GOOD[:length])
    else:
        assert _read(tmp_path, GOOD[:length]).trial.frame_count == min((length - START) // A_FRAME, 12)


def _mutated(generator: random.Random, content: bytes) -> bytes:
    changed = bytearray(content)
    for _ in range(generator.choice([1, 1, 2, 4, 16])):
        at = generator.randrange(min(len(changed), generator.choice([512, 6000, len(changed)])))
        match generator.randrange(5):
            case 0:
                changed[at] = generator.randrange(256)
            case 1:
                changed[at : at + 2] = generator.choice([b"\0\0", b"\xff\xff", b"\xff\x7f", b"\0\x80", b"\x01\0"])
            case 2:
                changed[at : at + 4] = struct.pack("<f", generator.choice([np.nan, np.inf, -1e38, 0.0, 1e-38, -1.0]))
            case 3:
                del changed[at : at + generator.randint(1, 300)]
            case 4:
                changed[at:at] = changed[at // 2 : at // 2 + generator.randint(1, 300)]
    return bytes(changed[: generator.randrange(len(changed))]) if generator.random() < 0.1 else bytes(changed)


FUZZED = (
    "made", "sample15_FP1_metres", "sample06_MACsample", "sample01_Eb015vr", "btk_shd01_prefix", "sample09_PlugInC3D",
)  # fmt: skip
MUTATIONS = 600
"""Files for the reader; a tenth of them go on to the body."""


@pytest.mark.parametrize("name", FUZZED)
def test_a_mutated_file_is_read_or_refused_in_a_sentence(captures: Path, tmp_path: Path, name: str) -> None:
    original = GOOD if name == "made" else (captures / "c3d" / f"{name}.c3d").read_bytes()
    path = tmp_path / "take.c3d"
    read = 0
    for seed in range(MUTATIONS // len(FUZZED)):
        path.write_bytes(_mutated(random.Random(f"{name}{seed}"), original))
        if seed % 10 == 0:
            record = file_record(path, GUESS_ALL)
            assert json.dumps(record, allow_nan=False)
            assert lines_of(record)
            assert record["ok"] or "take.c3d" in record["error"] or "'take'" in record["error"]
        with suppress(StudioError):
            read += read_c3d(path).trial.frame_count > 0
    assert 0 < read < MUTATIONS // len(FUZZED)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match=r"none\.c3d could not be read"):
        read_c3d(tmp_path / "none.c3d")


def test_a_file_with_signals_alone_says_how_many_samples_it_has(tmp_path: Path) -> None:
    trial = make_trial()
    nobody = replace(trial, labels=(), kinds=(), points=np.zeros((12, 0, 3)), residuals=np.zeros((12, 0)))
    with pytest.raises(StudioError, match=r"the file holds no points, only 6 signals of 48 samples\. Export it with"):
        _read(tmp_path, c3d_bytes(nobody))


def test_a_file_of_computed_points_alone_is_refused_as_such(tmp_path: Path) -> None:
    labels = ("AAngles", "BAngles", "CAngles", "LKneeAngles")
    (tmp_path / "take.c3d").write_bytes(c3d_bytes(make_trial(labels)))
    with pytest.raises(StudioError, match=r"take\.c3d shows no marker: all that is seen of its 4 points are computed"):
        load_capture(tmp_path / "take.c3d")


def test_a_file_whose_points_are_never_seen_is_refused(tmp_path: Path) -> None:
    content = bytearray(GOOD)
    for frame in range(12):
        for index in range(4):
            point(frame, index, 3, -1.0)(content)
    (tmp_path / "take.c3d").write_bytes(content)
    with pytest.raises(StudioError, match=r"take\.c3d shows no marker: none of its 4 points is ever seen"):
        load_capture(tmp_path / "take.c3d")
