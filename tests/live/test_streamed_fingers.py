"""Fingers in the stream: bones of Unity's names, bent as captured, closed as a clip asks, left out if unknown."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.finger_joints import Digit
from studio.core.body.finger_poses import FingerPoses
from studio.core.body.rest_pose import rest_pose
from studio.core.rigs.finger_rest import bend, relative_rotations
from studio.core.rotations import to_matrix
from studio.core.stage.clip import Clip
from studio.engine.posed_performer import pose_of
from studio.jobs.performances import stage_performances
from studio.live import vmc
from studio.live.streamer import packets_of
from studio.live.tracker import Inbox
from tests.builders import make_project
from tests.io.test_finger_export import fist_capture
from tests.live.test_streaming import BODIES

BODY = BODIES["child"]
CURL = np.radians([30.0, 50.0, 20.0])


def curled(angles: np.ndarray = CURL) -> FingerPoses:
    """All fingers but thumbs bent by these angles of their joints, as captured."""
    bends = np.zeros((2, 5, 3))
    bends[:, 1:] = np.cumsum(angles)
    one = np.ones(1)
    return FingerPoses(relative_rotations(bend(bends))[None], one, 0 * one, 0 * one)


def received(fingers: FingerPoses | None) -> dict[str, vmc.Bone]:
    inbox, (positions, rotations) = Inbox(), rest_pose(BODY)
    for packet in packets_of(positions, rotations, BODY, 0.5, fingers):
        inbox.receive(packet)
    return dict(inbox.bones())


def directions(bones: dict[str, vmc.Bone], side: str, digit: str) -> list[np.ndarray]:
    """Directions of the three bones of a finger from a T-pose with flat hands."""
    turn, out, found = np.eye(3), 1.0 if side == "Left" else -1.0, []
    for bone in vmc.VMC_FINGER_BONES:
        turn = turn @ to_matrix(bones[f"{side}{digit}{bone}"].rotation)
        found.append(turn @ [0.0, out, 0.0])
    return found


@pytest.mark.parametrize(("side", "out"), [("Left", 1.0), ("Right", -1.0)])
def test_streamed_fingers_bend_into_the_palm_by_the_captured_angles(side: str, out: float) -> None:
    bones = received(curled())
    for digit in ("Index", "Middle", "Ring", "Little"):
        for angle, found in zip(np.cumsum(CURL), directions(bones, side, digit), strict=True):
            assert found == pytest.approx([0.0, out * np.cos(angle), -np.sin(angle)], abs=1e-5)


def test_a_body_of_which_nobody_knows_the_fingers_streams_none() -> None:
    assert not [name for name in received(None) if any(digit.capitalize() in name for digit in Digit)]
    assert len([name for name in received(curled()) if any(digit.capitalize() in name for digit in Digit)]) == 30


def test_fingers_are_streamed_from_bodies_without_any_of_their_own_and_from_clips_that_ask_for_fists() -> None:
    captured = make_project(characters=1, constraints=0, contacts=0).with_entity(
        "captures", "capture", fist_capture(60)
    )
    performer = captured.performers["performer 0"]
    fists = make_project(characters=1, constraints=0, contacts=0).with_entity(
        "performers", "performer 0", replace(performer, clips=(Clip("motion", 0, 59, id="a", grip=1.0),))
    )
    plain = make_project(characters=1, constraints=0, contacts=0)
    bends = []
    for project in (captured, fists, plain):
        [(key, performance)] = stage_performances(project).performances.items()
        fingers = pose_of(project, key, performance.adapted, 0.9).streamed_fingers
        bends.append(None if fingers is None else directions(received(fingers), "Left", "Index")[-1])
    assert bends[0][2] < -0.5
    assert bends[1][1] < -0.1
    assert bends[2] is None
