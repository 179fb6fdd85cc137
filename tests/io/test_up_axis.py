"""Any axis of a file may be up, and the body stands; a camera's tilt is taken back, and doubt is told."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.humanoid import BodyPart
from studio.core.body.kinematics import joint_positions, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.io.bvh.writer import write_bvh
from studio.io.export import take_of_capture, write_take
from studio.io.guessing import METRES_PER_UNIT
from studio.io.importing import ImportOptions, load_capture
from studio.io.up_axis import (
    C3D_UP_PRIOR,
    FILE_AXES,
    BodyPoints,
    guess_up_axis,
    parse_axis,
    stated_axis_prior,
    turn_to_world,
)
from tests.io.fbx_text import fbx_text

WALK = Path(__file__).resolve().parents[2] / "examples" / "captures" / "walk_turn.bvh"


@pytest.fixture(scope="module")
def walk() -> Capture:
    return load_capture(WALK)


def turned(capture: Capture, turn: np.ndarray) -> Capture:
    """The same motion that a matrix (3, 3) turns to file axes, written as if Y were up; its rest pose stays."""
    turn = FILE_AXES["Y"] @ turn
    rotations, translations = capture.poses.local_rotations.copy(), capture.poses.local_translations.copy()
    rotations[:, 0] = (Rotation.from_matrix(turn) * Rotation.from_quat(rotations[:, 0])).as_quat()
    translations[:, 0] = translations[:, 0] @ turn.T
    return replace(capture, poses=PoseSequence(rotations, translations))


def read_back(capture: Capture, folder: Path, options: ImportOptions | None = None) -> Capture:
    path = folder / "turned.bvh"
    write_bvh(path, capture.skeleton, capture.poses, capture.frame_rate)
    return load_capture(path, options or ImportOptions())


def heights(capture: Capture) -> np.ndarray:
    return joint_positions(capture.skeleton, capture.poses)[..., 2] - capture.floor


def pairs(positions: np.ndarray, capture: Capture) -> BodyPoints:
    assert capture.body_map is not None
    return BodyPoints.of_joints(np.stack([positions[:-1], positions[1:]]), capture.body_map)


@pytest.mark.parametrize("axis", FILE_AXES)
def test_the_body_stands_whatever_axis_of_the_file_is_up(tmp_path: Path, walk: Capture, axis: str) -> None:
    read = read_back(turned(walk, FILE_AXES[axis].T), tmp_path)
    assert read.up_axis == axis
    assert np.abs(heights(read) - heights(walk)).max() < 2e-3
    assert any(guess.subject == "up axis" and f"stands along {axis}." in guess.reason for guess in read.guesses)


@pytest.mark.parametrize("degrees", [-30.0, 17.0, 28.0])
@pytest.mark.parametrize("about", ["x", "y"])
@pytest.mark.parametrize("axis", ["Y", "-Y"])
def test_the_tilt_of_a_camera_is_taken_back_and_told(
    tmp_path: Path, walk: Capture, axis: str, about: str, degrees: float
) -> None:
    tilt = Rotation.from_euler(about, degrees, degrees=True).as_matrix()
    read = read_back(turned(walk, FILE_AXES[axis].T @ tilt), tmp_path)
    up = turn_to_world(read.up_axis)[2]
    assert np.degrees(np.arccos(up @ (FILE_AXES[axis].T @ tilt)[:, 2])) < 3.0
    assert any("as a tilted camera sees it" in guess.reason for guess in read.guesses)
    assert read.body_map is not None
    standing = joint_positions(read.skeleton, rest_poses(read.skeleton, read.reference_rotations))[0]
    trunk = standing[read.body_map[BodyPart.NECK]] - standing[read.body_map.spine[0]]
    assert np.degrees(np.arccos(trunk[2] / np.linalg.norm(trunk))) < 5.0


@pytest.mark.parametrize("degrees", [-11.0, -6.0, 6.0, 9.0])
@pytest.mark.parametrize("about", ["x", "y"])
def test_a_slight_tilt_of_the_camera_is_told_by_the_floor_of_a_walk(
    tmp_path: Path, walk: Capture, about: str, degrees: float
) -> None:
    tilt = Rotation.from_euler(about, degrees, degrees=True).as_matrix()
    read = read_back(turned(walk, FILE_AXES["Y"].T @ tilt), tmp_path)
    up = turn_to_world(read.up_axis)[2]
    assert np.degrees(np.arccos(min(up @ (FILE_AXES["Y"].T @ tilt)[:, 2], 1.0))) < 1.0
    assert any("choose Y if it is a ramp" in guess.reason for guess in read.guesses)


@pytest.mark.parametrize("rise", [-0.15, -0.08, 0.08, 0.15])
def test_a_walk_on_a_ramp_is_seen_by_no_tilted_camera(tmp_path: Path, walk: Capture, rise: float) -> None:
    translations = walk.poses.local_translations.copy()
    translations[:, 0, 2] += rise * translations[:, 0, 0]
    ramp = replace(walk, poses=PoseSequence(walk.poses.local_rotations, translations))
    assert read_back(turned(ramp, FILE_AXES["Y"].T), tmp_path).up_axis == "Y"


def fbx(up: int, sign: int, unit: float) -> str:
    """The body of ``fbx_text``, Y up in centimetres, in a file that says otherwise."""
    said = fbx_text()
    for name, kind, usual, other in (
        ("UpAxis", '"int", "Integer"', 1, up),
        ("UpAxisSign", '"int", "Integer"', 1, sign),
        ("FrontAxis", '"int", "Integer"', 2, 3 - up),
        ("UnitScaleFactor", '"double", "Number"', 1, unit),
    ):
        assert f'"{name}", {kind}, "",{usual}' in said
        said = said.replace(f'"{name}", {kind}, "",{usual}', f'"{name}", {kind}, "",{other:g}')
    return said


@pytest.mark.parametrize(("up", "sign", "unit"), [(1, -1, 1.0), (2, 1, 1.0), (2, -1, 100.0), (1, 1, 0.1), (1, 1, 2.54)])
def test_an_fbx_that_says_another_axis_or_unit_than_its_body_has_stands_all_the_same(
    tmp_path: Path, up: int, sign: int, unit: float
) -> None:
    (tmp_path / "take.fbx").write_text(fbx(1, 1, 1.0))
    right = load_capture(tmp_path / "take.fbx")
    (tmp_path / "take.fbx").write_text(fbx(up, sign, unit))
    read = load_capture(tmp_path / "take.fbx")
    assert read.up_axis == "Y"
    if unit != 2.54:  # legs of 2.1 m are a giant's, as the file says
        assert np.abs(heights(read) - heights(right)).max() < 2e-3


@pytest.mark.parametrize(("unit", "axis"), [("dm", "Z"), ("cm", "Y"), ("mm", "-Y"), ("inch", "-Z"), ("foot", "X")])
def test_a_gltf_in_another_unit_and_along_another_axis_stands_as_tall(
    tmp_path: Path, walk: Capture, unit: str, axis: str
) -> None:
    turned_walk = turned(walk, FILE_AXES[axis].T)
    poses = PoseSequence(
        turned_walk.poses.local_rotations, turned_walk.poses.local_translations / METRES_PER_UNIT[unit]
    )
    skeleton = replace(walk.skeleton, offsets=walk.skeleton.offsets / METRES_PER_UNIT[unit])
    write_take(take_of_capture(replace(turned_walk, skeleton=skeleton, poses=poses)), tmp_path / "walk.glb")
    read = load_capture(tmp_path / "walk.glb")
    assert (read.unit, read.up_axis) == (unit, axis)
    same = [read.skeleton.index(name) for name in walk.skeleton.names]
    assert np.abs(heights(read)[:, same] - heights(walk)).max() < 5e-3
    assert {"unit", *({"up axis"} if axis != "Y" else ())} <= {guess.subject for guess in read.guesses}


def test_one_who_lies_or_crawls_through_the_take_is_not_stood_up(captures: Path) -> None:
    for stem in ("varied/accad_female1_A11_CrawlForward", "varied/accad_female1_A08_CrouchToLie"):
        capture = load_capture(captures / "bvh" / f"{stem}.bvh")
        positions = joint_positions(capture.skeleton, capture.poses) - [0.0, 0.0, capture.floor]
        for axis, turn in FILE_AXES.items():
            guess = guess_up_axis(pairs(positions @ turn, capture), C3D_UP_PRIOR)
            assert guess.value == axis
            assert "That is not certain" in guess.reason


def test_a_format_that_says_its_axis_is_believed_unless_the_body_stands_along_another(walk: Capture) -> None:
    positions = joint_positions(walk.skeleton, walk.poses) - [0.0, 0.0, walk.floor]
    upright = guess_up_axis(pairs(positions @ FILE_AXES["Y"], walk), stated_axis_prior("Y"))
    forgotten = guess_up_axis(pairs(positions @ FILE_AXES["Z"], walk), stated_axis_prior("Y"))
    assert (upright.value, forgotten.value) == ("Y", "Z")


def test_one_who_leans_over_more_and_more_is_seen_by_no_tilted_camera(walk: Capture) -> None:
    positions = joint_positions(walk.skeleton, walk.poses) - [0.0, 0.0, walk.floor]
    standing = np.repeat(positions[:1] - positions[0, 0] * [1.0, 1.0, 0.0], 60, axis=0)
    leans = Rotation.from_euler("y", np.linspace(0.0, 45.0, 60)[:, None], degrees=True).as_matrix()
    guess = guess_up_axis(
        pairs(np.einsum("fij,fpj->fpi", leans, standing) @ FILE_AXES["Y"], walk), stated_axis_prior("Y")
    )
    assert guess.value == "Y"


@pytest.mark.parametrize("axis", [*FILE_AXES, "0.0000 -0.9397 0.3420"])
def test_the_axis_that_is_called_becomes_up(axis: str) -> None:
    turn = turn_to_world(axis)
    named = FILE_AXES[axis][2] if axis in FILE_AXES else np.array([float(word) for word in axis.split()])
    assert np.abs(turn @ named - [0.0, 0.0, 1.0]).max() < 1e-4
    assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-9
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_an_axis_may_be_called_in_any_spelling(tmp_path: Path, walk: Capture) -> None:
    assert [parse_axis(text) for text in ("y", "+Z", "-x", "0, -2, 0")] == ["Y", "Z", "-X", "0.0000 -1.0000 0.0000"]
    assert read_back(walk, tmp_path, ImportOptions(up_axis="-y")).up_axis == "-Y"
    for text in ("W", "1 2", "0 0 0", "nan 0 1", ""):
        with pytest.raises(StudioError, match="is not an up axis"):
            parse_axis(text)
