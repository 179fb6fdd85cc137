"""Poses are finite unit quaternions without jumps of sign."""

import numpy as np
import pytest

from studio.core.body.pose import PoseSequence
from studio.core.errors import StudioError
from studio.core.rotations import normalized, sign_continuous


def _rotations(frames: int = 4, joints: int = 3) -> np.ndarray:
    return np.random.default_rng(0).normal(size=(frames, joints, 4))


def test_quaternions_become_unit_and_continuous() -> None:
    poses = PoseSequence(_rotations(), np.zeros((4, 3, 3)))
    assert np.allclose(np.linalg.norm(poses.local_rotations, axis=2), 1.0)
    assert (np.sum(poses.local_rotations[1:] * poses.local_rotations[:-1], axis=2) >= 0).all()
    assert (poses.frame_count, poses.joint_count) == (4, 3)


def test_translations_are_copied_unless_nobody_can_write_to_them() -> None:
    rotations, own = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1, 1)), np.zeros((2, 1, 3))
    poses = PoseSequence(rotations, own)
    own[:] = 1.0
    assert (poses.local_translations == 0.0).all()
    own.setflags(write=False)
    assert PoseSequence(rotations, own).local_translations is own


def test_rotations_that_their_caller_gives_up_are_not_copied() -> None:
    given = _rotations()
    copied = PoseSequence(given, np.zeros((4, 3, 3)))
    assert not np.shares_memory(copied.local_rotations, given)
    own = PoseSequence(given, np.zeros((4, 3, 3)), own=True)
    assert np.shares_memory(own.local_rotations, given)
    assert np.array_equal(own.local_rotations, copied.local_rotations)


def test_signs_are_those_that_lie_nearest_to_the_frame_before() -> None:
    given = _rotations(200, 5)
    poses = PoseSequence(given, np.zeros((200, 5, 3)))
    assert poses.local_rotations == pytest.approx(sign_continuous(normalized(given)), abs=1e-15)


def test_frames_are_counted_with_both_ends() -> None:
    poses = PoseSequence(_rotations(), np.arange(36.0).reshape(4, 3, 3))
    part = poses.frames(1, 2)
    assert part.frame_count == 2
    assert np.array_equal(part.local_translations, poses.local_translations[1:3])


@pytest.mark.parametrize(
    ("rotations", "translations", "sentence"),
    [
        (_rotations(), np.zeros((4, 2, 3)), "Poses need rotations"),
        (_rotations(0), np.zeros((0, 3, 3)), "at least one frame"),
        (np.zeros((4, 3, 4)), np.zeros((4, 3, 3)), "quaternion of length zero"),
        (_rotations() * np.nan, np.zeros((4, 3, 3)), "rotation of joint 0 in frame 0 is not a finite number"),
        (_rotations(), np.full((4, 3, 3), np.inf), "translation of joint 0 in frame 0 is not a finite"),
    ],
)
def test_poses_that_cannot_be_are_refused(rotations: np.ndarray, translations: np.ndarray, sentence: str) -> None:
    with pytest.raises(StudioError, match=sentence):
        PoseSequence(rotations, translations)
