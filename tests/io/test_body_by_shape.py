"""Bodies of BVH files are found by names, by what the user says, or else by their shape."""

import re
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_positions
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.io.capture_guesses import body_guesses
from studio.io.export import take_of_capture, write_take
from studio.io.figure.body_maps import FoundBody
from studio.io.importing import ImportOptions, load_capture
from studio.resources_folder import example_captures_folder

SIDES = (("Left", "Right"), ("Right", "Left"))
WALK = (example_captures_folder() / "walk_turn.bvh").read_text()
JOINTS = re.findall(r"(?:ROOT|JOINT) (\S+)", WALK)


def _renamed(tmp_path: Path, names: dict[str, str]) -> Path:
    text = re.sub(r"(ROOT|JOINT) (\S+)", lambda found: f"{found[1]} {names.get(found[2], found[2])}", WALK)
    (tmp_path / "walk.bvh").write_text(text)
    return tmp_path / "walk.bvh"


def test_where_names_say_nothing_shape_decides(tmp_path: Path) -> None:
    plain = load_capture(example_captures_folder() / "walk_turn.bvh")
    found = load_capture(_renamed(tmp_path, {name: f"J{index:02d}" for index, name in enumerate(JOINTS)}))
    assert plain.body_map is not None
    assert found.body_map is not None
    for part, joint in plain.body_map.parts.items():
        assert found.body_map.get(part) in (joint, None)


def test_a_head_without_a_neck_is_found_by_shape(tmp_path: Path) -> None:
    """The end site over it is no joint that could be the head."""
    names = [name for name in JOINTS if name != "Neck"]
    head, motion = WALK.split("MOTION")
    above = re.search(r"JOINT Neck\s*{\s*OFFSET (.+)\s*CHANNELS 3 (.+)", head)
    assert above is not None
    start = head.index("JOINT Neck")
    inner = head.index("JOINT Head", start)
    depth, at = 1, head.index("{", start) + 1
    while depth:
        depth += {"{": 1, "}": -1}.get(head[at], 0)
        at += 1
    body = head[:start] + head[inner : at - 1] + head[at:]
    body = re.sub(r"(ROOT|JOINT) (\S+)", lambda found: f"{found[1]} J{names.index(found[2]):02d}", body)
    column = 3 + 3 * JOINTS.index("Neck")
    lines = motion.strip().splitlines()
    rows = [" ".join(row.split()[:column] + row.split()[column + 3 :]) for row in lines[2:]]
    (tmp_path / "walk.bvh").write_text(body + "MOTION\n" + "\n".join([*lines[:2], *rows]) + "\n")
    found = load_capture(tmp_path / "walk.bvh")
    assert found.body_map is not None
    assert found.body_map.to_json(found.skeleton)["head"] == f"J{names.index('Head'):02d}"
    assert "neck" not in found.body_map.to_json(found.skeleton)


def test_low_arms_and_up_arms_are_names(tmp_path: Path) -> None:
    parts = {"Arm": "UpArm", "ForeArm": "LowArm", "Leg": "LowLeg"}
    names = {f"{side}{old}": f"{side}{new}" for side in ("Left", "Right") for old, new in parts.items()}
    found = load_capture(_renamed(tmp_path, names))
    assert found.body_map is not None
    assert found.body_map.to_json(found.skeleton)["left_forearm"] == "LeftLowArm"


def test_limbs_that_the_user_names_are_believed_however_long_their_bones(tmp_path: Path) -> None:
    """Bones of suits whose joints have places of their own drift; here a thigh grows to thrice itself."""
    capture = load_capture(example_captures_folder() / "walk_turn.bvh")
    assert capture.body_map is not None
    names = capture.body_map.to_json(capture.skeleton)
    head, motion = WALK.split("MOTION")
    lines = motion.strip().splitlines()
    index = JOINTS.index("LeftLeg")
    blocks = re.split(r"(?=JOINT )", head)
    block = next(k for k, each in enumerate(blocks) if each.startswith("JOINT LeftLeg"))
    offset = [float(number) for number in re.findall(r"OFFSET (.+)", blocks[block])[0].split()]
    blocks[block] = re.sub(r"CHANNELS 3 ", "CHANNELS 6 Xposition Yposition Zposition ", blocks[block], count=1)
    rows = []
    for frame, line in enumerate(lines[2:]):
        numbers = line.split()
        at = 3 + 3 * index
        grown = [str((1.0 + 2.0 * (frame % 2)) * each) for each in offset]
        rows.append(" ".join([*numbers[:at], *grown, *numbers[at:]]))
    path = tmp_path / "suit.bvh"
    path.write_text("".join(blocks) + "MOTION\n" + "\n".join([*lines[:2], *rows]) + "\n")
    found = load_capture(path, ImportOptions(body_map=names))
    assert found.body_map is not None
    assert found.body_map.to_json(found.skeleton) == names
    with pytest.raises(StudioError, match="must hang below each other"):
        load_capture(path, ImportOptions(body_map=names | {"left_shank": names["right_hand"]}))


def _divided(text: str, bones: dict[str, str]) -> str:
    """The file with a joint in the middle of each bone, from a joint to the one below it, that turns about nothing."""
    head, motion = text.split("MOTION")
    lines = motion.strip().splitlines()
    order = list(JOINTS)
    for upper, lower in bones.items():
        block = re.search(rf"JOINT {lower}\s*\{{\s*OFFSET (.+)", head)
        assert block is not None
        half = " ".join(str(0.5 * float(number)) for number in block[1].split())
        begin, end = block.start(), _closing(head, block.start())
        inner = head[begin:end].replace(f"OFFSET {block[1]}", f"OFFSET {half}", 1)
        middle = f"JOINT {upper}02 {{ OFFSET {half} CHANNELS 3 Zrotation Xrotation Yrotation\n"
        head = f"{head[:begin]}{middle}{inner}}}\n{head[end:]}"
        at = order.index(lower)
        order.insert(at, f"{upper}02")
        rows = [line.split() for line in lines[2:]]
        lines[2:] = [" ".join([*row[: 3 + 3 * at], "0", "0", "0", *row[3 + 3 * at :]]) for row in rows]
    return f"{head}MOTION\n" + "\n".join(lines) + "\n"


def _closing(text: str, start: int) -> int:
    depth = 0
    for at in range(text.index("{", start), len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return at + 1
    raise AssertionError("a brace is open")


BONES = {
    f"{side}{upper}": f"{side}{lower}"
    for side in ("Left", "Right")
    for upper, lower in (("Arm", "ForeArm"), ("ForeArm", "Hand"), ("UpLeg", "Leg"), ("Leg", "Foot"))
}


@pytest.mark.parametrize("tips", [True, False])
@pytest.mark.parametrize("spelling", ["J{place}", "{name}_part{number}", "{name}.00{number}", "{name}{letter}"])
def test_joints_that_only_divide_a_bone_are_no_elbows_and_knees(tmp_path: Path, spelling: str, tips: bool) -> None:
    """By a number behind the name, or by the motion where names say nothing; also where hands have no tips."""
    plain = load_capture(example_captures_folder() / "walk_turn.bvh")
    assert plain.body_map is not None
    limbs = {*BONES, *(f"{upper}02" for upper in BONES)}
    path = tmp_path / "walk.bvh"

    def spelled(found: re.Match[str]) -> str:
        name, number = found[2].removesuffix("02"), 2 if found[2].endswith("02") else 1
        if "{name}" in spelling and found[2] not in limbs:
            return found[0]
        place = sum(map(ord, found[2]))
        return f"{found[1]} {spelling.format(name=name, number=number, letter=' ab'[number], place=place)}"

    text = re.sub(r"(ROOT|JOINT) (\S+)", spelled, _divided(WALK, BONES))
    path.write_text(text if tips else re.sub(r"End Site\s*\{[^}]*\}", "", text))
    found = load_capture(path)
    assert found.body_map is not None
    for part, joint in plain.body_map.parts.items():
        if part in found.body_map.parts:
            here = joint_positions(found.skeleton, found.poses)[:, found.body_map[part]]
            there = joint_positions(plain.skeleton, plain.poses)[:, joint]
            assert np.abs(here - there).max() < 1e-3, part


@pytest.mark.parametrize(
    ("part", "bone", "confidence"),
    [
        (None, None, Confidence.LIKELY),
        ("hand", "ForeArm", Confidence.DOUBTFUL),
        ("forearm", "Arm", Confidence.DOUBTFUL),
        ("foot", "Leg", Confidence.DOUBTFUL),
    ],
)
def test_a_body_by_shape_that_ends_a_bone_half_way_is_told_as_doubtful(
    tmp_path: Path, part: str | None, bone: str | None, confidence: Confidence
) -> None:
    path = tmp_path / "walk.bvh"
    path.write_text(_divided(WALK, BONES))
    plain = load_capture(path)
    assert plain.body_map is not None
    joints = plain.body_map.to_json(plain.skeleton)
    if part:
        joints |= {f"{side.lower()}_{part}": f"{side}{bone}02" for side in ("Left", "Right")}
    found = FoundBody(BodyMap.from_json(plain.skeleton, joints), "", ())
    (guess,) = body_guesses(plain.skeleton, found, ImportOptions())
    assert guess.confidence is confidence
    assert ("not divided like a person's" in guess.reason) == (part is not None)


@pytest.mark.parametrize("suffix", [".bvh", ".glb"])
@pytest.mark.parametrize("limbs", [("legs",), ("arms",), ("legs", "arms")])
def test_limbs_that_bear_the_names_of_the_other_side_are_put_right_and_told(
    tmp_path: Path, limbs: tuple[str, ...], suffix: str
) -> None:
    plain = load_capture(example_captures_folder() / "walk_turn.bvh")
    bare = {"legs": ("UpLeg", "Leg", "Foot", "ToeBase"), "arms": ("Shoulder", "Arm", "ForeArm", "Hand")}
    pairs = [(f"{one}{name}", f"{two}{name}") for limb in limbs for name in bare[limb] for one, two in SIDES]
    path = _renamed(tmp_path, dict(pairs))
    if suffix == ".glb":
        read = load_capture(path, ImportOptions(body_map=plain.body_map.to_json(plain.skeleton)))  # as it is named
        path = path.with_suffix(suffix)
        write_take(take_of_capture(read), path)
    found = load_capture(path)
    assert found.body_map is not None
    assert plain.body_map is not None
    for part, joint in plain.body_map.parts.items():
        name = plain.skeleton.names[joint]
        assert found.skeleton.names[found.body_map[part]] == dict(pairs).get(name, name)
    [guess] = [guess for guess in found.guesses if guess.subject == "sides"]
    assert guess.value == f"left and right of {' and '.join(limbs)} exchanged"


def test_names_that_agree_with_the_body_are_left_alone(captures: Path) -> None:
    for stem in ("varied/accad_female1_A11_CrawlForward", "varied/accad_female1_A08_CrouchToLie"):
        read = load_capture(captures / "bvh" / f"{stem}.bvh")
        assert not any(guess.subject == "sides" for guess in read.guesses)


@pytest.mark.parametrize(
    ("name", "called"),
    [("Shoulder", "Arm"), ("ToeBase", "Foot"), ("UpLeg", "Leg"), ("Neck", "Head"), ("Spine1", "Spine")],
)
def test_two_joints_of_one_name_in_a_chain_are_told_apart_by_where_they_lie(
    tmp_path: Path, name: str, called: str
) -> None:
    plain = load_capture(example_captures_folder() / "walk_turn.bvh")
    path = tmp_path / "walk.bvh"
    path.write_text(re.sub(rf"(ROOT|JOINT) (Left|Right|){name}$", rf"\1 \2{called}", WALK, flags=re.MULTILINE))
    found = load_capture(path)
    assert plain.body_map is not None
    assert found.body_map is not None
    limbs = {
        part: joint
        for part, joint in plain.body_map.parts.items()
        if "TOE" not in part.name and "CLAV" not in part.name
    }
    assert {part: found.body_map.parts[part] for part in limbs} == limbs
