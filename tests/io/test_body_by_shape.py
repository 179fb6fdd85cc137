"""Bodies of BVH files are found by names, by what the user says, or else by their shape."""

import re
from pathlib import Path

import pytest

from studio.core.errors import StudioError
from studio.io.importing import ImportOptions, load_capture
from studio.resources_folder import example_captures_folder

WALK = (example_captures_folder() / "walk_turn.bvh").read_text()
JOINTS = re.findall(r"(?:ROOT|JOINT) (\S+)", WALK)


def _renamed(tmp_path: Path, names: dict[str, str]) -> Path:
    text = re.sub(r"(ROOT|JOINT) (\S+)", lambda found: f"{found[1]} {names.get(found[2], found[2])}", WALK)
    (tmp_path / "walk.bvh").write_text(text)
    return tmp_path / "walk.bvh"


def test_where_names_say_nothing_shape_decides(tmp_path: Path) -> None:
    plain = load_capture(example_captures_folder() / "walk_turn.bvh")
    found = load_capture(_renamed(tmp_path, {name: f"J{place:02d}" for place, name in enumerate(JOINTS)}))
    assert plain.body_map is not None
    assert found.body_map is not None
    for part, joint in plain.body_map.parts.items():
        assert found.body_map.get(part) in (joint, None)


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
    place = JOINTS.index("LeftLeg")
    blocks = re.split(r"(?=JOINT )", head)
    block = next(k for k, each in enumerate(blocks) if each.startswith("JOINT LeftLeg"))
    offset = [float(number) for number in re.findall(r"OFFSET (.+)", blocks[block])[0].split()]
    blocks[block] = re.sub(r"CHANNELS 3 ", "CHANNELS 6 Xposition Yposition Zposition ", blocks[block], count=1)
    rows = []
    for frame, line in enumerate(lines[2:]):
        numbers = line.split()
        at = 3 + 3 * place
        grown = [str((1.0 + 2.0 * (frame % 2)) * each) for each in offset]
        rows.append(" ".join([*numbers[:at], *grown, *numbers[at:]]))
    path = tmp_path / "suit.bvh"
    path.write_text("".join(blocks) + "MOTION\n" + "\n".join([*lines[:2], *rows]) + "\n")
    found = load_capture(path, ImportOptions(body_map=names))
    assert found.body_map is not None
    assert found.body_map.to_json(found.skeleton) == names
    with pytest.raises(StudioError, match="must hang below each other"):
        load_capture(path, ImportOptions(body_map=names | {"left_shank": names["right_hand"]}))
