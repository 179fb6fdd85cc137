"""ASF and AMC: joints where the format's own rule puts them, the body found, bad files refused with their line."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.humanoid import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.errors import StudioError
from studio.io.acclaim.capture import AcclaimFile, read_acclaim
from studio.io.importing import load_capture
from tests.io.acclaim_text import BONES, FRAMES, amc_text, asf_text, axis_of, motion


def expected(frame: dict[str, list[float]], name: str) -> np.ndarray:
    """Place at which the bone ``name`` begins: up the hierarchy by the rule C M C^-1, in matrices of scipy."""
    chain = [name]
    while chain[-1] != "root":
        chain.append(BONES[chain[-1]][0])
    x, y, z, *angles = frame["root"]
    turned = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    place = np.array([x, y, z])
    for bone in chain[-2:0:-1]:
        _, direction, length, channels = BONES[bone]
        own, order = axis_of(bone)
        axis = Rotation.from_euler(order.lower(), [own["XYZ".index(each)] for each in order], degrees=True).as_matrix()
        if channels:
            order = "".join(channel[1] for channel in channels.split())
            moved = Rotation.from_euler(order, frame[bone] if len(order) > 1 else frame[bone][0], degrees=True)
            turned = turned @ axis @ moved.as_matrix() @ axis.T
        place = place + length * turned @ (np.array(direction) / np.linalg.norm(direction))
    return place


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    (tmp_path / "07.asf").write_text(asf_text(), encoding="utf-8")
    path = tmp_path / "07_01.amc"
    path.write_text(amc_text(motion()), encoding="utf-8")
    return path


def places(file: AcclaimFile) -> np.ndarray:
    return joint_positions(file.skeleton, PoseSequence(file.rotations, file.translations))


def test_every_joint_lies_where_the_rule_of_the_format_puts_it(pair: Path) -> None:
    file = read_acclaim(pair)
    found = places(file)
    for number, frame in enumerate(motion()):
        for name in BONES:
            wanted = expected(frame, name)
            np.testing.assert_allclose(found[number, file.skeleton.names.index(name)], wanted, atol=1e-6)


def test_the_body_its_size_and_its_up_axis_are_found_and_the_rate_is_told_as_a_guess(pair: Path) -> None:
    capture = load_capture(pair)
    assert capture.body_map is not None
    joints = {part: capture.skeleton.names[joint] for part, joint in capture.body_map.parts.items()}
    assert joints[BodyPart.LEFT_SHANK] == "ltibia"
    assert joints[BodyPart.RIGHT_HAND] == "rwrist"
    assert joints[BodyPart.LEFT_TOE] == "ltoes"
    assert (capture.up_axis, capture.unit, capture.frame_rate) == ("Y", "cmu", 120.0)
    assert any(guess.subject == "frame rate" for guess in capture.guesses)


def test_radians_give_the_same_motion(pair: Path) -> None:
    in_degrees = places(read_acclaim(pair))
    frames = [
        {
            name: own[:3] + np.radians(own[3:]).tolist() if name == "root" else np.radians(own).tolist()
            for name, own in each.items()
        }
        for each in motion()
    ]
    pair.write_text(amc_text(frames, ":FULLY-SPECIFIED\n:RADIANS\n"), encoding="utf-8")
    np.testing.assert_allclose(places(read_acclaim(pair)), in_degrees, atol=1e-5)


def test_the_only_skeleton_of_the_folder_is_taken_and_told(pair: Path) -> None:
    pair.with_name("07.asf").rename(pair.with_name("another.asf"))
    assert any("another.asf" in repair for repair in read_acclaim(pair).repairs)


def test_a_motion_without_its_skeleton_is_refused_with_what_to_do(pair: Path) -> None:
    pair.with_name("07.asf").unlink()
    with pytest.raises(StudioError, match=r"needs its skeleton, an ASF file, and its folder holds none.*07\.asf"):
        read_acclaim(pair)


def test_a_skeleton_alone_is_refused_with_what_to_choose(pair: Path) -> None:
    with pytest.raises(StudioError, match=r"07\.asf is a skeleton without a motion. Choose the AMC file"):
        load_capture(pair.with_name("07.asf"))


def test_a_file_cut_within_a_frame_loses_that_frame_and_says_so(pair: Path) -> None:
    text = pair.read_text(encoding="utf-8")
    pair.write_text(text[: text.rindex("lowerback")], encoding="utf-8")
    file = read_acclaim(pair)
    assert file.frame_count == FRAMES - 1
    assert any("cut off" in repair for repair in file.repairs)


def test_a_bone_that_a_frame_leaves_out_is_filled_from_its_neighbours_and_told(pair: Path) -> None:
    frames = motion()
    del frames[7]["lfemur"]
    pair.write_text(amc_text(frames), encoding="utf-8")
    file = read_acclaim(pair)
    joint = file.skeleton.names.index("lfoot")
    assert np.linalg.norm(places(file)[7, joint] - expected(motion()[7], "lfoot")) < 0.01
    assert any("frame 7: 'lfemur'" in repair for repair in file.repairs)


def test_an_angle_that_passes_half_a_turn_is_filled_the_short_way(pair: Path) -> None:
    frames = motion()
    for number, frame in enumerate(frames):
        frame["ltibia"] = [(170.0 + 2.0 * number + 180.0) % 360.0 - 180.0]
    wanted = expected(frames[7], "lfoot")
    frames[7] = {name: own for name, own in frames[7].items() if name != "ltibia"}
    pair.write_text(amc_text(frames), encoding="utf-8")
    file = read_acclaim(pair)
    np.testing.assert_allclose(places(file)[7, file.skeleton.names.index("lfoot")], wanted, atol=1e-5)


REFUSED_MOTIONS = {
    "too few numbers": (lambda text: re.sub(r"ltibia \S+", "ltibia", text, count=1), "'ltibia' has 0 numbers where"),
    "a word": (lambda text: text.replace("17.00000000", "high", 1), "line 5: 'high' is not a number"),
    "no frame": (lambda text: text[: text.index("\n1\n")] + "\n", "there is no frame in this file"),
}


@pytest.mark.parametrize("case", REFUSED_MOTIONS)
def test_a_motion_that_cannot_be_read_is_refused_with_its_line(pair: Path, case: str) -> None:
    change, sentence = REFUSED_MOTIONS[case]
    pair.write_text(change(pair.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(StudioError, match=sentence):
        read_acclaim(pair)


REFUSED_SKELETONS = {
    "a bone that is not there": (("root lhipjoint", "root lhip"), "there is no bone called 'lhip'"),
    "a bone twice": (("root lhipjoint", "root lhipjoint lfemur"), "is parented a second time"),
    "a channel that is none": (("dof rx ry rz", "dof rx qy rz"), "not by 'qy'"),
    "an order that is none": (("axis XYZ", "axis XYX"), "'XYX' is not an order of three axes"),
    "a word for a number": (("length 7.0", "length long"), "'long' is not a number"),
    "no root": ((":root", ":roots"), "it has no :root section"),
    "no hierarchy": ((":hierarchy", ":hierarchies"), "its :hierarchy names no bone"),
}


@pytest.mark.parametrize("case", REFUSED_SKELETONS)
def test_a_skeleton_that_cannot_be_read_is_refused_with_its_line(pair: Path, case: str) -> None:
    (old, new), sentence = REFUSED_SKELETONS[case]
    asf = pair.with_name("07.asf")
    asf.write_text(asf.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    with pytest.raises(StudioError, match=sentence):
        read_acclaim(pair)
