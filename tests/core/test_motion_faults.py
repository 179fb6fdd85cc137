"""Spikes, exchanged limbs and tremble are found in noisy motion and taken off it; clean motion stays as it is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.captures.motion_faults import MotionFaults, clean_motion
from studio.core.rotations import from_matrix, inverse, multiply, normalized, shortest_arc, to_matrix
from studio.io.importing import load_capture
from studio.resources_folder import example_captures_folder
from tests.captures import outside_files

FloatArray = NDArray[np.float64]
RATE = 30.0


def at_30_hz(path: Path) -> Capture:
    """A capture with as many frames a second as webcams have."""
    capture = load_capture(path)
    frames = np.arange(capture.first_frame, capture.frame_count, max(1, round(capture.frame_rate / RATE)))
    poses = PoseSequence(capture.poses.local_rotations[frames], capture.poses.local_translations[frames])
    return replace(capture, poses=poses, frame_rate=RATE, first_frame=0)


@pytest.fixture(scope="module")
def walk() -> Capture:
    return at_30_hz(example_captures_folder() / "walk_turn.bvh")


def cleaned(capture: Capture, poses: PoseSequence) -> tuple[PoseSequence, MotionFaults]:
    assert capture.body_map is not None
    positions = joint_positions(capture.skeleton, poses)
    return clean_motion(poses, positions, capture.body_map, capture.frame_rate)


def errors(capture: Capture, poses: PoseSequence) -> FloatArray:
    """Metres (F, J) by which joints are not where the capture has them."""
    places = (joint_positions(capture.skeleton, each) for each in (capture.poses, poses))
    return np.asarray(np.linalg.norm(np.subtract(*places), axis=-1))


def rotated(capture: Capture, vectors: FloatArray) -> PoseSequence:
    """Poses with each joint rotated by its vector (F, J, 3), radians."""
    angles = np.linalg.norm(vectors, axis=-1, keepdims=True)
    turns = np.concatenate([np.sin(angles / 2) * vectors / np.maximum(angles, 1e-12), np.cos(angles / 2)], axis=-1)
    return PoseSequence(multiply(capture.poses.local_rotations, turns), capture.poses.local_translations)


@pytest.mark.parametrize("path", sorted(example_captures_folder().glob("*.bvh")), ids=lambda path: path.stem)
def test_a_clean_take_has_no_faults_and_stays_as_it_is(path: Path) -> None:
    capture = load_capture(path)
    for take in (capture, at_30_hz(path)):
        poses, faults = cleaned(take, take.poses)
        assert not faults.any
        assert poses is take.poses


FAULTY = "accad_male2_G10_RoundhouseLeadingLeft"
"""A kick whose toes are turned by 73 degrees for two frames."""


@pytest.mark.parametrize("path", outside_files("bvh/*/*.bvh"))
def test_kicks_strikes_and_dances_of_suits_are_not_taken_for_noise(path: Path) -> None:
    capture = load_capture(path)
    if capture.body_map is not None:
        assert cleaned(capture, capture.poses)[1].any == (path.stem == FAULTY)


def test_tremble_is_measured_and_more_than_halved(walk: Capture) -> None:
    random = np.random.default_rng(1)
    noisy = rotated(walk, np.radians(3.0) * random.normal(size=(*walk.poses.local_rotations.shape[:2], 3)))
    translations = noisy.local_translations.copy()
    translations[:, 0] += 0.015 * random.normal(size=translations[:, 0].shape)
    noisy = PoseSequence(noisy.local_rotations, translations)
    poses, faults = cleaned(walk, noisy)
    assert faults.tremble == pytest.approx(np.radians(3.0), rel=0.2)
    assert faults.root_tremble == pytest.approx(0.015, rel=0.2)
    assert np.median(errors(walk, poses)) < 0.5 * np.median(errors(walk, noisy))


def test_spikes_are_counted_and_led_through_from_the_frames_around(walk: Capture) -> None:
    assert walk.body_map is not None
    vectors = np.zeros((*walk.poses.local_rotations.shape[:2], 3))
    for frame, length, part in ((20, 1, "LEFT_FOREARM"), (50, 3, "RIGHT_SHANK"), (90, 2, "HEAD"), (91, 1, "LEFT_HAND")):
        vectors[frame : frame + length, walk.body_map[BodyPart[part]], 0] = np.radians(110.0)
    poses, faults = cleaned(walk, rotated(walk, vectors))
    assert faults.spikes == 4
    assert not faults.trembles
    assert not faults.swaps
    touched = vectors.any(axis=(1, 2))
    assert errors(walk, poses)[~touched].max() == pytest.approx(0.0, abs=1e-9)
    assert errors(walk, poses)[touched].max() < 0.05


def test_a_root_that_leaps_away_for_a_moment_is_brought_back(walk: Capture) -> None:
    translations = walk.poses.local_translations.copy()
    translations[30:32, 0, 1] += 0.6
    poses, faults = cleaned(walk, PoseSequence(walk.poses.local_rotations, translations))
    assert faults.spikes == 1
    assert errors(walk, poses).max() < 0.02


def exchanged(capture: Capture, frames: slice) -> PoseSequence:
    """Knees and ankles where those of the other side are, as detectors that mix up legs have them."""
    assert capture.body_map is not None
    rotations = capture.poses.local_rotations.copy()
    places = joint_positions(capture.skeleton, capture.poses)
    for side, other in (("LEFT", "RIGHT"), ("RIGHT", "LEFT")):
        for upper, lower in (("THIGH", "SHANK"), ("SHANK", "FOOT")):
            joint, end, goal = (
                capture.body_map[BodyPart[f"{s}_{part}"]] for s, part in ((side, upper), (side, lower), (other, lower))
            )
            poses = PoseSequence(rotations, capture.poses.local_translations)
            now, world = joint_positions(capture.skeleton, poses), world_rotations(capture, rotations)
            swing = from_matrix(
                shortest_arc(normalized(now[:, end] - now[:, joint]), normalized(places[:, goal] - now[:, joint]))
            )
            parent = world[:, capture.skeleton.parents[joint]]
            turned = multiply(inverse(parent), multiply(swing, world[:, joint]))
            rotations[frames, joint] = turned[frames]
    return PoseSequence(rotations, capture.poses.local_translations)


def world_rotations(capture: Capture, rotations: FloatArray) -> FloatArray:
    """World rotations (F, J, 4) of local ones."""
    world = rotations.copy()
    for joint, parent in enumerate(capture.skeleton.parents):
        if parent >= 0:
            world[:, joint] = multiply(world[:, parent], rotations[:, joint])
    return from_matrix(to_matrix(world))


@pytest.mark.parametrize(("first", "last"), [(40, 40), (60, 66), (100, 112)])
def test_legs_that_are_exchanged_for_a_moment_are_found_and_put_right(walk: Capture, first: int, last: int) -> None:
    wrong = exchanged(walk, slice(first, last + 1))
    poses, faults = cleaned(walk, wrong)
    assert [limb for limb, *_ in faults.swaps] == ["legs"]
    assert abs(faults.swaps[0][1] - first) <= 1
    assert abs(faults.swaps[0][2] - last) <= 1
    assert walk.body_map is not None
    legs = [walk.body_map[BodyPart[f"{side}_{part}"]] for side in ("LEFT", "RIGHT") for part in ("SHANK", "FOOT")]
    assert errors(walk, poses)[:, legs].mean() < 0.5 * errors(walk, wrong)[:, legs].mean()
    assert errors(walk, poses)[: first - 1].max() < 1e-9


def test_who_runs_in_place_with_narrow_steps_exchanges_no_legs(walk: Capture) -> None:
    assert walk.body_map is not None
    time = np.arange(90) / RATE
    vectors = np.zeros((90, walk.skeleton.joint_count, 3))
    for side, phase in (("LEFT", 0.0), ("RIGHT", np.pi)):
        vectors[:, walk.body_map[BodyPart[f"{side}_THIGH"]], 0] = 0.8 * np.sin(2 * np.pi * 2.0 * time + phase)
    still = PoseSequence(
        np.repeat(walk.poses.local_rotations[:1], 90, axis=0), np.repeat(walk.poses.local_translations[:1], 90, axis=0)
    )
    runner = rotated(_with(walk, still), vectors)
    assert not cleaned(walk, runner)[1].swaps


def _with(capture: Capture, poses: PoseSequence) -> Capture:
    return replace(capture, poses=poses)
