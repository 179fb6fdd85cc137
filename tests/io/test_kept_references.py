"""Reference poses are kept for each skeleton, and used by takes that show less of a body at ease."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.rigs.zero_pose import with_zero_pose
from studio.core.rotations import multiply
from studio.io.export import write_capture
from studio.io.figure.kept_references import references_folder, skeleton_digest, with_reference_kept
from studio.io.importing import load_capture
from studio.library.catalogue import Catalogue
from studio.library.indexing import index_folders
from tests.builders import make_skeleton
from tests.core.motions import about, swaying

LEFT = (0.0, 1.0, 0.0)


def _take(folder: Path, name: str, frames: int, lean: float, look: float = 0.0) -> Path:
    """A file of one actor, whose zero pose is not human, leaning forward and looking aside by so many degrees."""
    capture = swaying(2, frames=frames, amplitude=0.15, hinged=True)
    rotations = np.array(capture.poses.local_rotations)
    hips = capture.skeleton.index("Hips")
    rotations[:, hips] = multiply(about(LEFT, np.radians(lean)), rotations[:, hips])
    head = capture.skeleton.index("Head")
    rotations[:, head] = multiply(about((0.0, 0.0, 1.0), np.radians(look)), rotations[:, head])
    take = replace(capture, poses=replace(capture.poses, local_rotations=rotations))
    random = np.random.default_rng(5)
    axes = np.eye(3)[[random.permutation(3) for _ in range(take.skeleton.joint_count)]]
    axes[:, :, 0] *= np.linalg.det(axes)[:, None]
    path = folder / f"{name}.bvh"
    write_capture(with_zero_pose(take, axes), path)
    return path


def _guess(capture: Capture) -> Guess:
    return next(guess for guess in capture.guesses if guess.subject == "reference pose")


@pytest.fixture
def calm(tmp_path: Path) -> Path:
    return _take(tmp_path, "calm", 240, 0.0)


@pytest.fixture
def bow(tmp_path: Path) -> Path:
    return _take(tmp_path, "bow", 60, 25.0)


def test_reading_a_file_keeps_nothing(calm: Path) -> None:
    assert _guess(load_capture(calm)).value == "all frames"
    assert not references_folder().exists()


def test_a_take_uses_the_reference_pose_of_one_at_ease_for_longer_and_says_so(calm: Path, bow: Path) -> None:
    alone = load_capture(bow)
    surest = with_reference_kept(load_capture(calm))
    found = load_capture(bow)
    assert not np.array_equal(alone.reference_rotations, surest.reference_rotations)
    assert np.array_equal(found.reference_rotations, surest.reference_rotations)
    assert _guess(found).value == "all frames of calm"
    assert "kept from calm, which shows this skeleton at ease more surely" in _guess(found).reason


def test_a_take_that_is_surer_replaces_the_pose_that_is_kept_and_keeps_its_own(calm: Path, bow: Path) -> None:
    with_reference_kept(load_capture(bow))
    own = load_capture(calm)
    assert _guess(own).value == "all frames"
    with_reference_kept(own)
    assert _guess(load_capture(bow)).value == "all frames of calm"
    assert np.array_equal(load_capture(calm).reference_rotations, own.reference_rotations)


def test_a_take_that_looks_aside_throughout_uses_the_pose_of_one_that_looks_ahead(calm: Path, tmp_path: Path) -> None:
    aside = _take(tmp_path, "aside", 300, 0.0, look=50.0)
    assert _guess(load_capture(aside)).confidence is Confidence.DOUBTFUL
    with_reference_kept(load_capture(calm))
    found = _guess(load_capture(aside))
    assert (found.value, found.confidence) == ("all frames of calm", Confidence.LIKELY)


def test_a_library_keeps_the_reference_poses_of_its_takes(calm: Path, bow: Path, tmp_path: Path) -> None:
    with Catalogue(tmp_path / "library") as catalogue:
        index_folders(catalogue, [tmp_path])
    assert _guess(load_capture(bow)).value == "all frames of calm"


def test_a_skeleton_with_other_bones_has_a_reference_pose_of_its_own(calm: Path, bow: Path) -> None:
    with_reference_kept(load_capture(calm))
    text = bow.read_text()
    bones = [line for line in text.splitlines() if line.strip().startswith("OFFSET")]
    bow.write_text(text.replace(bones[5], f"{bones[5]}1"))
    assert _guess(load_capture(bow)).value == "all frames"


def test_a_damaged_file_is_told_and_replaced(calm: Path, bow: Path) -> None:
    with_reference_kept(load_capture(calm))
    (path,) = references_folder().iterdir()
    path.write_text('{"take": "calm"}')
    assert "is not a kept reference pose" in _guess(load_capture(bow)).reason
    with_reference_kept(load_capture(calm))
    assert _guess(load_capture(bow)).value == "all frames of calm"


@pytest.mark.parametrize("far", [1e17, 1e300])
def test_a_bone_as_long_as_no_integer_has_a_skeleton_that_is_known_again(far):
    skeleton = make_skeleton()
    damaged = replace(skeleton, offsets=skeleton.offsets * far)
    assert skeleton_digest(damaged) == skeleton_digest(damaged) != skeleton_digest(skeleton)
