"""BVH files are read as they say and written so that nothing is lost."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import from_euler, to_matrix
from studio.io.bvh.reader import BvhFile, read_bvh, write_bvh
from studio.io.bvh.writer import _continued
from tests.builders import make_poses, make_skeleton
from tests.io.bvh_text import HIERARCHY, ROW, bvh_text


def _read(tmp_path: Path, text: str, encoding: str = "utf-8") -> BvhFile:
    path = tmp_path / "take.bvh"
    path.write_bytes(text.encode(encoding))
    return read_bvh(path)


def test_joints_channels_and_numbers_are_what_the_file_says(tmp_path: Path) -> None:
    file = _read(tmp_path, bvh_text())
    assert file.skeleton.names == ("Hips", "Spine", "Spine_end")
    assert file.skeleton.parents.tolist() == [-1, 0, 1]
    assert file.skeleton.end_sites.tolist() == [False, False, True]
    assert file.frames.shape == (3, 9)
    assert file.frame_time == 0.0333333
    assert file.repairs == ()


def test_every_joint_turns_in_its_own_order(tmp_path: Path) -> None:
    poses = _read(tmp_path, bvh_text()).poses()
    root = from_euler("ZXY", np.radians([10.0, 20.0, 30.0]))
    spine = from_euler("YZX", np.radians([5.0, -5.0, 10.0]))
    assert np.allclose(to_matrix(poses.local_rotations[0, 0]), to_matrix(root))
    assert np.allclose(to_matrix(poses.local_rotations[0, 1]), to_matrix(spine))


def test_position_channels_replace_the_offset(tmp_path: Path) -> None:
    moving = HIERARCHY.replace("CHANNELS 3 Yrotation", "CHANNELS 4 Yposition Yrotation")
    poses = _read(tmp_path, bvh_text([ROW.replace("30 5", "30 21 5")], moving, "Frames: 1\nFrame Time: 0.01\n")).poses()
    assert poses.local_translations[0, 0].tolist() == [1.5, 90, -2]
    assert poses.local_translations[0, 1].tolist() == [0, 21, 0]


def test_a_root_that_lists_rotations_first_stands_where_it_stands(tmp_path: Path) -> None:
    turned_first = HIERARCHY.replace(
        "Xposition Yposition Zposition Zrotation Xrotation Yrotation",
        "Zrotation Xrotation Yrotation Xposition Yposition Zposition",
    )
    row = "10 20 30 1.5 90 -2 5 -5 1e1"
    assert np.array_equal(
        _read(tmp_path, bvh_text([row] * 3, turned_first)).poses().local_translations,
        _read(tmp_path, bvh_text()).poses().local_translations,
    )


@pytest.mark.parametrize(
    ("change", "encoding"),
    [
        (lambda text: text.replace("\n", "\r\n"), "utf-8"),
        (lambda text: text.replace("\n", "\r"), "utf-8"),
        (lambda text: text, "utf-8-sig"),
        (lambda text: text, "utf-16"),
        (lambda text: text.replace(" ", "\t"), "utf-8"),
        (lambda text: text.replace("\n{", " {"), "utf-8"),
        (lambda text: " ".join(HIERARCHY.split()) + "\n" + text[len(HIERARCHY) :], "utf-8"),
        (lambda text: text.replace("Frame Time:", "Frame Time :").replace("Frames:", "FRAMES:"), "utf-8"),
        (lambda text: text.replace(ROW, "\n" + ROW + "  \n"), "utf-8"),
        (lambda text: text.replace(ROW, ROW.replace(" 10", "\n10")), "utf-8"),
    ],
    ids=[
        "crlf",
        "cr",
        "bom",
        "utf-16",
        "tabs",
        "braces",
        "one-line",
        "header",
        "blank-lines",
        "wrapped-rows",
    ],
)
def test_the_same_file_written_differently_reads_the_same(tmp_path: Path, change, encoding: str) -> None:  # type: ignore[no-untyped-def]
    file = _read(tmp_path, change(bvh_text()), encoding)
    assert file.skeleton.names == ("Hips", "Spine", "Spine_end")
    assert np.array_equal(file.frames, _read(tmp_path, bvh_text()).frames)
    assert file.repairs == ()


def test_names_may_hold_anything(tmp_path: Path) -> None:
    odd = HIERARCHY.replace("JOINT Spine", "JOINT Bip01 L Thigh/é:#1").replace("Hips", "Motion")
    assert _read(tmp_path, bvh_text(hierarchy=odd)).skeleton.names[:2] == (
        "Motion",
        "Bip01 L Thigh/é:#1",
    )


def test_thousands_of_nested_joints_are_read_without_recursion(tmp_path: Path) -> None:
    depth = 3000
    joints = "".join(f"JOINT j{k} {{ OFFSET 0 1 0 CHANNELS 1 Xrotation\n" for k in range(depth))
    hierarchy = f"HIERARCHY ROOT r {{ OFFSET 0 0 0 CHANNELS 1 Xrotation\n{joints}{'}' * (depth + 1)}\n"
    row = " ".join(["0"] * (depth + 1))
    file = _read(tmp_path, bvh_text([row], hierarchy, "Frames: 1\nFrame Time: 0.01\n"))
    assert file.skeleton.depths[-1] == depth
    write_bvh(tmp_path / "again.bvh", file.skeleton, file.poses(), 100.0)
    assert read_bvh(tmp_path / "again.bvh").skeleton.names == file.skeleton.names


def _worst_distance(skeleton: Skeleton, poses: PoseSequence, path: Path) -> float:
    """Metres between ``poses`` and what stands in the written file, over all joints and frames."""
    file = read_bvh(path)
    again = joint_world(file.skeleton, file.poses())[0][..., [2, 0, 1]] / 100.0
    order = [file.skeleton.index(name) for name in skeleton.names if name in file.skeleton.names]
    kept = [joint for joint, name in enumerate(skeleton.names) if name in file.skeleton.names]
    return float(np.abs(again[:, order] - joint_world(skeleton, poses)[0][:, kept]).max())


@pytest.mark.parametrize("seed", range(5))
def test_what_is_written_reads_back_within_a_hundredth_of_a_millimetre(tmp_path: Path, seed: int) -> None:
    skeleton, random = make_skeleton(), np.random.default_rng(seed)
    shape = (40, skeleton.joint_count)
    translations = skeleton.offsets + 0.05 * random.normal(size=(*shape, 3)) * ~skeleton.end_sites[:, None]
    translations[:, 0] += 50.0 * random.normal(size=(40, 3))
    poses = PoseSequence(random.normal(size=(*shape, 4)), translations)
    write_bvh(tmp_path / "take.bvh", skeleton, poses, 60.0)
    assert _worst_distance(skeleton, poses, tmp_path / "take.bvh") < 1e-5
    assert read_bvh(tmp_path / "take.bvh").frame_time == pytest.approx(1 / 60, abs=1e-10)


def test_only_joints_that_travel_get_positions(tmp_path: Path) -> None:
    skeleton = make_skeleton()
    write_bvh(tmp_path / "take.bvh", skeleton, make_poses(skeleton), 60.0)
    assert [len(channels) for channels in read_bvh(tmp_path / "take.bvh").channels if channels][:3] == [
        6,
        3,
        3,
    ]


def test_angles_go_on_through_the_whole_of_a_long_file(tmp_path: Path) -> None:
    """The root turns ten times, a long file is written in runs of frames: no angle jumps back by a turn."""
    poses = make_poses(make_skeleton(), frames=1300)
    turns = np.linspace(0.0, 20 * np.pi, 1300)
    rotations = poses.local_rotations.copy()
    rotations[:, 0] = from_euler("Z", turns[:, None])
    write_bvh(tmp_path / "turns.bvh", make_skeleton(), PoseSequence(rotations, poses.local_translations), 60.0)
    frames = read_bvh(tmp_path / "turns.bvh").frames
    assert np.abs(np.diff(frames[:, 3:6], axis=0)).max() < 10.0
    assert np.ptp(frames[:, 3:6], axis=0).max() == pytest.approx(3600.0, abs=1e-3)


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    skeleton = make_skeleton()
    with pytest.raises(StudioError, match="could not be written"):
        write_bvh(tmp_path / "missing" / "take.bvh", skeleton, make_poses(skeleton), 60.0)
    target = tmp_path / "folder.bvh"
    target.mkdir()
    with pytest.raises(StudioError, match="could not be written"):
        write_bvh(target, skeleton, make_poses(skeleton), 60.0)
    assert [path.name for path in tmp_path.iterdir()] == ["folder.bvh"]


def test_fewer_decimals_make_a_smaller_file_that_still_is_within_a_hundredth_of_a_millimetre(tmp_path: Path) -> None:
    skeleton = make_skeleton()
    poses = make_poses(skeleton)
    write_bvh(tmp_path / "whole.bvh", skeleton, poses, 60.0)
    write_bvh(tmp_path / "short.bvh", skeleton, poses, 60.0, decimals=4)
    frames = read_bvh(tmp_path / "short.bvh").frames
    assert np.allclose(frames, frames.round(4), rtol=0.0, atol=1e-12)
    assert (tmp_path / "short.bvh").stat().st_size < 0.9 * (tmp_path / "whole.bvh").stat().st_size
    assert _worst_distance(skeleton, poses, tmp_path / "short.bvh") < 1e-5
    assert not any(word == "-0" for word in (tmp_path / "short.bvh").read_text().split())


@pytest.mark.parametrize("noise", [1e-13, -1e-13])
def test_a_step_of_half_a_turn_goes_the_same_way_however_its_last_digit_is_rounded(noise: float) -> None:
    angles = np.array([0.0, np.pi, 0.0, -np.pi, 0.0])[:, None, None] * np.ones(3)
    nothing = np.empty((0, 1, 3))
    assert np.abs(_continued(nothing, angles + noise) - _continued(nothing, angles)).max() < 1e-9
