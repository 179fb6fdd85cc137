"""Files nobody vetted: each case is repaired and listed, or refused in a sentence with file and line.

The list never shrinks.
"""

import random
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.io.bvh.reader import BvhFile, read_bvh
from studio.io.importing import load_capture
from tests.io.bvh_text import HIERARCHY, ROW, bvh_text
from tests.io.refused import refused

POSITIONS = "Xposition Yposition Zposition"


def _read(tmp_path: Path, content: str | bytes) -> BvhFile:
    path = tmp_path / "take.bvh"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_bvh(path)


def _rows(bad: str) -> str:
    """The file with ``bad`` in the place of 90 on its second row, line 20."""
    return bvh_text([ROW, ROW.replace("90", bad), ROW])


def joints(of: str, others: str) -> str:
    """The file with a part of its hierarchy replaced."""
    return bvh_text(hierarchy=HIERARCHY.replace(of, others))


def timed(frame_time: str) -> str:
    return bvh_text(header=f"Frames: 3\nFrame Time: {frame_time}\n")


REFUSED = {
    "empty": ("", "take.bvh is empty"),
    "only spaces": (" \n\t\n", "take.bvh is empty"),
    "binary": (b"\x7fELF\0\0\1\2", "take.bvh, byte 4: this is binary data"),
    "binary in the motion": (bvh_text().encode() + b"\0\0", "this is binary data"),
    "another format": ("ply\nformat ascii 1.0\n", "take.bvh, line 1: a BVH file begins with HIERARCHY"),
    "another format with motion": ("solid x\nMOTION\n1 2\n", "line 1: a BVH file begins with HIERARCHY"),
    "no motion": (HIERARCHY, "take.bvh, line 15: the file ends before MOTION"),
    "cut in the hierarchy": (HIERARCHY[:100], "the file ends before MOTION"),
    "no root": ("HIERARCHY\nMOTION\nFrames: 0\n", "no ROOT joint is declared"),
    "no frames": (bvh_text([], header="Frames: 0\nFrame Time: 0.01\n"), "there is no complete frame"),
    "cut in the motion header": (
        HIERARCHY + "MOTION\nFrames: 3\nFrame Ti",
        "take.bvh, line 18: there is no complete frame in this file, though it says Frames: 3",
    ),
    "cut after the motion header": (
        bvh_text([]),
        "take.bvh, line 20: there is no complete frame in this file, though it says Frames: 3",
    ),
    "cut in the first frame": (bvh_text([ROW[:9]], end=""), "take.bvh, line 19: there is no complete frame"),
    "cut in the last number of the only frame": (bvh_text([ROW], end=""), "take.bvh, line 19: there is no complete"),
    "cut in the word motion": (HIERARCHY + "MOTI", "take.bvh, line 16: the file ends before MOTION"),
    "nothing after motion": (HIERARCHY + "MOTION\n", "there is no complete frame"),
    "underscore": (_rows("1_000"), "take.bvh, line 20: '1_000' is not a number"),
    "arabic digits": (_rows("٩٠"), "take.bvh, line 20: '٩٠' is not a number"),
    "hexadecimal": (_rows("0x5a"), "line 20: '0x5a' is not a number"),
    "two signs": (_rows("--90"), "line 20: '--90' is not a number"),
    "joined numbers": (_rows("90-1"), "line 20: '90-1' is not a number"),
    "two points": (_rows("9.0.1"), "line 20: '9.0.1' is not a number"),
    "lone point": (_rows("."), "line 20: '.' is not a number"),
    "cut exponent": (_rows("1e"), "line 20: '1e' is not a number"),
    "word": (_rows("NaN#QNAN"), "line 20: 'NaN#QNAN' is not a number"),
    "endless word": (_rows("x" * 5000), "line 20: 'x{40}…' is not a number"),
    "too large": (_rows("1e300"), "line 20: '1e300' is out of range"),
    "overflow": (_rows("1e999"), "line 20: '1e999' is out of range"),
    "comma decimals": (_rows("90,5"), "line 20: '90,5' is not a number. Commas seem to be decimals"),
    "comma offset": (joints("0 20 0", "0.5 20,5 0"), "line 8: '20,5' is not a number. Commas seem"),
    "a channel without any number": (
        bvh_text([ROW.replace("90", "nan")] * 3),
        "take.bvh: Yposition of 'Hips' has no number in any row",
    ),
    "nan offset": (joints("0 20 0", "0 nan 0"), "line 8: 'nan' is not a number"),
    "short offset": (joints("0 20 0", "0 20"), "line 9: 'CHANNELS' is not a number"),
    "short row": (bvh_text([ROW, ROW[:-4], ROW]), "line 20: 8 numbers stand here where 9 should stand"),
    "long row": (bvh_text([ROW, ROW + " 7", ROW]), "line 20: 10 numbers stand here where 9 should stand"),
    "rows that make up for each other": (bvh_text([ROW[:-4], ROW + " 7", ROW]), "line 19: 8 numbers"),
    "one line with a number too many": (bvh_text([" ".join([ROW] * 3) + " 7"]), "line 19: 28 numbers stand here"),
    "only a part of a row": (bvh_text(["1 2 3"], header="Frame Time: 0.01\n"), "there is no complete frame"),
    "unknown channel": (joints("Zposition", "Wposition"), "line 5: 'Wposition' is not a channel"),
    "channel twice": (joints("Yposition", "Xposition"), "line 5: joint 'Hips' declares Xposition twice"),
    "too few channels named": (joints("CHANNELS 3", "CHANNELS 4"), "line 10: 'End' is not a channel"),
    "too many channels": (
        joints("CHANNELS 3", "CHANNELS 700000000"),
        "line 9: joint 'Spine' declares 7e\\+08 channels",
    ),
    "ten channels": (
        joints("CHANNELS 3", "CHANNELS 10"),
        "line 9: joint 'Spine' declares 10 channels; a joint has 0 to 9",
    ),
    "scale twice": (joints("CHANNELS 3", "CHANNELS 5 Xscale Xscaling"), "line 9: joint 'Spine' declares Xscale twice"),
    "a name that is never opened, of words of the format": (
        joints("JOINT Spine\n  {", "JOINT Spine End\n"),
        "line 8: '{' is missing after joint 'Spine End'",
    ),
    "half a channel": (joints("CHANNELS 3", "CHANNELS 2.5"), "declares 2.5 channels"),
    "no channels": (bvh_text(hierarchy="HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\n"), "no joint declares channels"),
    "root inside a joint": (joints("JOINT Spine", "ROOT Spine"), "line 6: a root stands inside a joint"),
    "missing brace": (joints("Hips\n{", "Hips\n"), "line 4: '{' is missing after"),
    "brace too many": (bvh_text(hierarchy=HIERARCHY + "}\n"), "line 16: } stands outside every joint"),
    "offset outside": ("HIERARCHY\nOFFSET 1 2 3\nMOTION\n", "line 2: OFFSET stands outside every joint"),
    "end site outside": ("HIERARCHY\nEnd Site\n{\n}\nMOTION\n", "line 2: End Site stands outside every joint"),
    "unknown word": (joints("OFFSET 0 20", "OFSET 0 20"), "line 8: 'OFSET' is not"),
    "unknown header": (bvh_text(header="Frames: 3\nColour: red\n"), "line 18: 'colour' is not part of"),
    "too many joints": (
        bvh_text(hierarchy="HIERARCHY\n" + "ROOT a\n{\n" + "JOINT b\n{\n" * 5000 + "}\n" * 5001),
        "more than 4096 joints are declared",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused_in_a_sentence(tmp_path: Path, case: str) -> None:
    content, sentence = REFUSED[case]
    words = sentence.replace(". ", r"\. ").replace("} stands", r"\} stands")
    told = refused(read_bvh, tmp_path / "take.bvh", content, words)
    assert told.startswith("take.bvh")
    assert told.rstrip().endswith(".")


NO_NUMBER = (
    "nan", "-inf", "1.#IND", "-1.#IND00", "1.#QNAN", "null", "-nan(ind)", "1,#QNAN", "-1,#IND", "#QNAN", "-#IND",
    "#N/A", "NA", "(null)", "---", "-", "?", "*", "missing",
)  # fmt: skip
FILLED = "line 20: 1 row lacks numbers; what is missing was filled from the rows before and after."
POINTS = "take.bvh: its numbers have decimal commas; they were read as points."
BLANKS = "commas between them; they were read as blanks."
REPAIRED = {
    **{word: (_rows(word), 3, FILLED) for word in NO_NUMBER},
    "a row of zeros": (
        bvh_text([ROW, " ".join(["0.000"] * 9), ROW]),
        3,
        "line 20: 1 row lacks numbers or holds zeros alone; what is missing was filled from the rows before and after.",
    ),
    "a row that begins with a word behind a hash": (bvh_text([ROW, " ".join(["#N/A"] * 9), ROW]), 3, FILLED),
    "decimal commas and the word of a German C library": (
        bvh_text(
            [ROW.replace(".", ","), ROW.replace("90", "1.#IND").replace(".", ","), ROW.replace(".", ",")],
            header="Frames: 3\nFrame Time: 0.0333\n",
        ),
        3,
        POINTS,
    ),
    "decimal commas but for the frame time": (
        bvh_text([ROW.replace(".", ",")] * 3, header="Frames: 3\nFrame Time: 0.0333\n"),
        3,
        POINTS,
    ),
    "decimal commas but for the offsets": (
        bvh_text([ROW.replace(".", ",")] * 3, hierarchy=HIERARCHY.replace("0 90 0", "0.5 90.0 0.25")),
        3,
        POINTS,
    ),
    "decimal commas in the offsets only": (
        bvh_text([ROW] * 3, hierarchy=HIERARCHY.replace("0 90 0", "0,5 90,0 0,25")),
        3,
        POINTS,
    ),
    "decimal commas between semicolons but for the offsets": (
        bvh_text([ROW.replace(" ", ";").replace(".", ",")] * 3, hierarchy=HIERARCHY.replace("0 90 0", "0.5 90.0 0.25")),
        3,
        POINTS,
    ),
    "all frames on one line": (
        bvh_text([" ".join([ROW] * 3)]),
        3,
        "take.bvh, line 19: lines do not end where frames do; 9 numbers are a frame.",
    ),
    "lines of ten numbers": (
        bvh_text([" ".join((f"{ROW} " * 3).split()[start : start + 10]) for start in (0, 10, 20)]),
        3,
        "take.bvh, line 19: lines do not end where frames do; 9 numbers are a frame.",
    ),
    "semicolons": (bvh_text([ROW.replace(" ", ";")] * 3), 3, "semicolons between them; they were read as blanks."),
    "semicolons and decimal commas": (bvh_text([ROW.replace(" ", "; ").replace(".", ",")] * 3), 3, POINTS),
    "commas and blanks between": (bvh_text([ROW.replace(" ", ", ")] * 3), 3, BLANKS),
    "commas between": (bvh_text([ROW.replace(" ", ",")] * 3), 3, BLANKS),
    "commas in one row only": (bvh_text([ROW, ROW.replace(" ", ","), ROW]), 3, BLANKS),
    "commas in offsets": (joints("0 20 0", "0,20,0"), 3, BLANKS),
    "glued numbers": (
        bvh_text([ROW, ROW.replace(" -", "-"), ROW]),
        3,
        "take.bvh, line 20: numbers stand there without a blank",
    ),
    "glued offset": (joints("0 20 0", "0.0-20.5 0"), 3, "take.bvh, line 8: numbers stand there without a blank"),
    "an offset without a blank behind its word": (
        joints("OFFSET 0 20 0", "OFFSET-0.5-20.5 0"),
        3,
        "take.bvh, line 8: numbers stand there without a blank",
    ),
    "frame time in words": (timed("fast"), 3, "line 18: Frame Time fast is not valid"),
    "frame time nan": (timed("nan"), 3, "line 18: Frame Time nan is not valid"),
    "frame time with a comma": (
        bvh_text(header="Frame Time: 0,033\n"),
        3,
        "line 17: Frame Time 0,033 was read as 0.033 s.",
    ),
    "frame time as a fraction of zero": (bvh_text(header="Frame Time: 1/0\n"), 3, "Frame Time 1/0 is not valid"),
    "more rows than said": (bvh_text([ROW] * 4), 4, "take.bvh, line 17: the file says Frames: 3; found and read: 4."),
    "fewer rows than said": (
        bvh_text([ROW] * 2),
        2,
        "take.bvh, line 17: the file says Frames: 3; found and read: 2. The last is on line 20:",
    ),
    "absurd frames": (bvh_text(header="Frames: 999999999999\nFrame Time: 0.01\n"), 3, "says Frames: 999999999999"),
    "negative frames": (bvh_text(header="Frames: -1\nFrame Time: 0.01\n"), 3, "says Frames: -1"),
    "no frames line": (bvh_text(header="Frame Time: 0.01\n"), 3, "does not say how many frames"),
    "no frame time": (bvh_text(header="Frames: 3\n"), 3, "take.bvh, line 16: the file has no Frame Time"),
    "frame time zero": (timed("0"), 3, "take.bvh, line 18: Frame Time 0 is not valid"),
    "frame time negative": (timed("-1"), 3, "take.bvh, line 18: Frame Time -1 is not"),
    "frame time in milliseconds": (timed("33.3"), 3, "take.bvh, line 18: Frame Time 33.3 is not"),
    "cut row": (
        bvh_text([ROW, ROW, "1.5 90"], end=""),
        2,
        "take.bvh, line 21: the last row is cut off and was dropped",
    ),
    "cut row before a line break": (bvh_text([ROW, ROW, "1.5 90"]), 2, "take.bvh, line 21: the last row is cut off"),
    "cut number": (bvh_text([ROW, ROW, ROW[:-1]], header="Frames: 9\nFrame Time: 0.01\n", end=""), 2, "line 21"),
    "frame time in milliseconds with an exponent": (timed("333e5"), 3, "take.bvh, line 18: Frame Time 333e5 is not"),
    "frame time without a value": (bvh_text(header="Frames: 3\nFrame Time:\n"), 3, "line 18: the file has no Frame"),
    "frames without a value": (
        bvh_text(header="Frames:\nFrame Time: 0.01\n"),
        3,
        "line 17: the file does not say how many",
    ),
    "frames in words": (bvh_text(header="Frames: many\nFrame Time: 0.01\n"), 3, "line 17: the file says Frames: many"),
    "cut row of many promised": (
        bvh_text([ROW, "1.5 90"], header="Frames: 361\nFrame Time: 0.01\n", end=""),
        1,
        "take.bvh, line 17: the file says Frames: 361; found and read: 1. The last is on line 19:",
    ),
    "second root": (
        bvh_text(hierarchy=HIERARCHY + "ROOT Other\n{\nOFFSET 0 0 0\n}\n"),
        3,
        "take.bvh, line 16: 'Other' is another root; it was kept beside the first.",
    ),
    "positions that count from the offsets": (
        bvh_text([ROW[:19] + "0 0.1 0 " + ROW[19:]] * 3, HIERARCHY.replace("CHANNELS 3 ", f"CHANNELS 6 {POSITIONS} ")),
        3,
        "take.bvh: the positions of its joints count from their offsets; they were added to them.",
    ),
    "scaled joints": (
        bvh_text(
            [f"{ROW} 1 1.5 1"] * 3,
            HIERARCHY.replace("CHANNELS 3 ", "CHANNELS 6 ").replace(
                "Zrotation Xrotation\n    End", "Zrotation Xrotation Xscale Yscale Zscale\n    End"
            ),
        ),
        3,
        "take.bvh: joints are scaled ('Spine' the first of them); their scales were not applied.",
    ),
    "decimal commas throughout": (
        bvh_text([ROW.replace(".", ",")] * 3, header="Frames: 3\nFrame Time: 0,0333\n"),
        3,
        POINTS,
    ),
    "joint names twice": (
        joints("JOINT Spine", "JOINT Hips"),
        3,
        "take.bvh, line 6: a second joint is called 'Hips'; it was renamed 'Hips_2'",
    ),
    "joint without a name": (joints("JOINT Spine", "JOINT"), 3, "take.bvh, line 6: this joint has no name"),
    "brace never closed": (
        bvh_text(hierarchy=HIERARCHY[:-2]),
        3,
        "take.bvh, line 2: the brace of joint 'Hips' is never closed",
    ),
}


@pytest.mark.parametrize("case", REPAIRED)
def test_it_is_repaired_and_listed(tmp_path: Path, case: str) -> None:
    content, frames, repair = REPAIRED[case]
    file = _read(tmp_path, content)
    assert len(file.frames) == frames
    assert any(repair in listed for listed in file.repairs), file.repairs


PLAIN = bvh_text()


@pytest.mark.parametrize(
    "case", ["semicolons", "semicolons and decimal commas", "commas and blanks between", "commas between"]
)
def test_other_marks_between_numbers_change_no_number(tmp_path: Path, case: str) -> None:
    assert np.array_equal(_read(tmp_path, REPAIRED[case][0]).frames, _read(tmp_path, PLAIN).frames)


@pytest.mark.parametrize(
    "written",
    [
        ("MOTION", "MOTION:"),
        ("Frames: 3", "Frames = 3"),
        ("Frames: 3", "Frames=3"),
        ("Frame Time: ", "Frame_Time: "),
        ("Frame Time: ", "Frame Time = "),
        ("position", "translation"),
        ("position", "_Position"),
        ("rotation", "rot"),
    ],
)
def test_other_spellings_of_words_change_no_number(tmp_path: Path, written: tuple[str, str]) -> None:
    file, plain = _read(tmp_path, PLAIN.replace(*written)), _read(tmp_path, PLAIN)
    assert np.array_equal(file.frames, plain.frames)
    assert (file.channels, file.frame_time, file.repairs) == (plain.channels, plain.frame_time, plain.repairs)


@pytest.mark.parametrize("codec", ["utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-32-le", "utf-8-sig"])
def test_letters_of_several_bytes_are_read_with_a_mark_or_without(tmp_path: Path, codec: str) -> None:
    assert np.array_equal(_read(tmp_path, PLAIN.encode(codec)).frames, _read(tmp_path, PLAIN).frames)


def test_glued_numbers_are_those_that_stand_apart(tmp_path: Path) -> None:
    glued = _read(tmp_path, REPAIRED["glued numbers"][0])
    assert np.array_equal(glued.frames, _read(tmp_path, PLAIN).frames)
    columns = bvh_text([f"{x:8.4f}{y:8.4f}{z:8.4f}" * 3 for x, y, z in ((-12.5, 123.25, 7.0), (1.0, 2.0, -103.5))])
    assert _read(tmp_path, columns).frames[:, :3].tolist() == [[-12.5, 123.25, 7.0], [1.0, 2.0, -103.5]]
    assert _read(tmp_path, REPAIRED["glued offset"][0]).skeleton.offsets[1].tolist() == [0.0, -20.5, 0.0]


def test_a_row_without_numbers_lies_between_its_neighbours_and_angles_turn_the_shorter_way(tmp_path: Path) -> None:
    rows = ["0 90 0 170 0 0 0 0 0", " ".join(["nan"] * 9), "0 94 0 -170 0 0 0 0 0"]
    frames = _read(tmp_path, bvh_text(rows)).frames
    assert frames[1, 1] == pytest.approx(92.0)
    assert frames[1, 3] % 360.0 == pytest.approx(180.0)
    assert frames[[0, 2], 3].tolist() == [170.0, -170.0]


def test_first_rows_of_zeros_and_zeros_of_a_body_in_place_are_poses(tmp_path: Path) -> None:
    zero, bent = " ".join(["0"] * 9), "0 0 0 40 0 0 0 0 0"
    for rows in ([zero, ROW, ROW], [bent, zero, bent]):
        file = _read(tmp_path, bvh_text(rows))
        assert not file.frames[rows.index(zero)].any()
        assert not file.repairs


def test_a_travelling_body_that_would_not_bend_has_angles_in_radians(tmp_path: Path) -> None:
    def walk(travels: float, bends: float) -> BvhFile:
        return _read(tmp_path, bvh_text([f"{step * travels} 90 0 0 1.57 0 0 {step * bends} 0" for step in range(3)]))

    radians = walk(50.0, 0.7)
    assert radians.frames[2].tolist() == pytest.approx([100, 90, 0, 0, np.degrees(1.57), 0, 0, np.degrees(1.4), 0])
    assert radians.repairs == (
        "take.bvh: its angles were read as radians; as degrees, a body that travels would not bend by more than 1.4.",
    )
    for degrees in (walk(10.0, 0.7), walk(50.0, 7.0), walk(50.0, 0.2)):
        assert degrees.frames[0, 4] == 1.57
        assert not degrees.repairs


@pytest.mark.parametrize(
    "header",
    [
        "Frame Time: 16.6667 ms",
        "Frame Time: 60 fps",
        "Frame Time: 60Hz",
        "Frame Rate: 60",
        "FPS: 60",
        "framerate: 60.0",
    ],
)
def test_a_frame_time_may_have_a_unit_or_be_a_rate(tmp_path: Path, header: str) -> None:
    file = _read(tmp_path, bvh_text(header=f"Frames: 3\n{header}\n"))
    assert file.frame_time == pytest.approx(1.0 / 60.0, rel=1e-5)
    assert any("was read as 0.0166667 s." in repair for repair in file.repairs)


@pytest.mark.parametrize(("text", "rate"), [("1/60", 60.0), ("1 / 30", 30.0), ("1/29.97", 29.97), ("0.02 s", 50.0)])
def test_a_frame_time_may_be_a_fraction(tmp_path: Path, text: str, rate: float) -> None:
    file = _read(tmp_path, bvh_text(header=f"Frames: 3\nFrame Time: {text}\n"))
    assert file.frame_time == pytest.approx(1.0 / rate)
    assert any(f"Frame Time {text} was read as" in repair for repair in file.repairs) is ("/" in text or " s" in text)


def test_two_ends_of_one_joint_get_names_of_their_own(tmp_path: Path) -> None:
    end = "    End Site\n    {\n      OFFSET 0 30 0\n    }\n"
    file = _read(tmp_path, joints(end, end + end))
    assert file.skeleton.names == ("Hips", "Spine", "Spine_end", "Spine_end_2")


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.bvh", tmp_path):
        with pytest.raises(StudioError, match="could not be read"):
            load_capture(path)


def test_a_file_of_another_kind_is_refused_with_the_kinds_there_are(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("hello")
    with pytest.raises(StudioError, match=r"notes\.txt is not a capture the studio reads\. It reads BVH"):
        load_capture(path)


def test_a_file_cut_anywhere_opens_with_its_whole_frames_or_is_refused_with_file_and_line(tmp_path: Path) -> None:
    """At every byte: up to the first whole row it is refused, after it each missing frame is owned to."""
    text = bvh_text()
    for length in range(1, len(text) - len(ROW.split()[-1] + "\n") + 1):
        whole = text[:length].count(ROW + "\n")
        if whole == 0:
            with pytest.raises(StudioError, match=r"^take\.bvh, line \d+: "):
                _read(tmp_path, text[:length])
        else:
            file = _read(tmp_path, text[:length])
            assert len(file.frames) == whole
            assert any(f"Frames: 3; found and read: {whole}." in repair for repair in file.repairs)
            assert all(repair.startswith("take.bvh, line ") for repair in file.repairs)


@pytest.mark.parametrize("seed", range(20))
def test_mutated_files_load_or_are_refused_and_nothing_else(tmp_path: Path, seed: int) -> None:
    generator = random.Random(seed)
    original = bvh_text().encode()
    pieces = [
        b"{",
        b"}",
        b"\n",
        b" ",
        b"-",
        b"1e400",
        b"nan",
        b"\0",
        b"MOTION",
        b"JOINT x",
        b"\xff",
        b"99999999999",
        b",",
    ]
    for _ in range(25):
        content = bytearray(original)
        for _ in range(generator.randint(1, 6)):
            at = generator.randrange(len(content))
            content[at : at + generator.randint(0, 12)] = generator.choice(pieces)
        (tmp_path / "take.bvh").write_bytes(content)
        with suppress(StudioError):
            assert load_capture(tmp_path / "take.bvh").frame_count >= 1
