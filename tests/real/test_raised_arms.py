"""Hands that the actor has above the floor do not sink into it on bodies with longer arms."""

import numpy as np
import pytest

from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.grounding.raised_arms import raise_arms
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

BODIES = bundled_characters()
WALKS = ["walk", *outside("accad_female1_B03_Walk1")]
LOW = "accad_female1_A05_PickUpBox", "accad_female1_B21_PutDownBoxToWalk", "accad_female1_A08_CrouchToLie"


@pytest.mark.parametrize("stem", ["box_lift", "floor_reach", *outside(*LOW)])
@pytest.mark.parametrize("name", BODIES)
def test_no_hand_is_below_the_floor_and_none_snaps(stem: str, name: str) -> None:
    capture, motion, actor = taken(named(stem))
    body, first = BODIES[name].morphology, capture.first_frame
    adapted = adapt(AdaptRequest(motion, body, contacts_of(capture)), first)
    for side in range(2):
        wrist = body.layout.wrist_point(side)
        assert adapted.positions[:, wrist : wrist + 2, 2].min() > -0.005
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < 2.5


@pytest.mark.parametrize("stem", WALKS)
def test_hands_high_above_the_ground_are_left_as_they_are(stem: str) -> None:
    capture, motion, _ = taken(named(stem))
    body = BODIES["giant"].morphology
    standing = grounded_motion_of(AdaptRequest(motion, body, contacts_of(capture)))
    positions, rotations = standing.positions.copy(), standing.rotations.copy()
    raise_arms(body, Ground(), None, motion.frame_rate, positions, rotations)
    assert np.array_equal(positions, standing.positions)
    assert np.array_equal(rotations, standing.rotations)
    raise_arms(body, Ground(1.2 * body.leg_length), None, motion.frame_rate, positions, rotations)
    assert not np.array_equal(positions, standing.positions)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("stem", WALKS)
def test_hands_that_hang_into_the_ground_bend_back_rather_than_their_arms(stem: str, name: str) -> None:
    capture, motion, _ = taken(named(stem))
    body = BODIES[name].morphology
    standing = grounded_motion_of(AdaptRequest(motion, body, contacts_of(capture)))
    wrists = np.array([body.layout.wrist_point(side) for side in range(2)])
    before, rotations = np.asarray(standing.positions, dtype=np.float64).copy(), standing.rotations.copy()
    fingers = np.linalg.norm(before[:, wrists + 1] - before[:, wrists], axis=2).max()
    ground = Ground(float(before[:, wrists + 1, 2].min()) + 0.5 * fingers)
    after = before.copy()
    raise_arms(body, ground, None, motion.frame_rate, after, rotations)
    rises, tips = after[..., 2] - before[..., 2], after[:, wrists + 1, 2] - ground.height
    assert tips.min() > -0.005
    assert rises[:, wrists + 1].sum() > 2.0 * rises[:, wrists].sum()
    forearms, hands = after[:, wrists] - after[:, wrists - 1], after[:, wrists + 1] - after[:, wrists]
    cosines = np.sum(forearms * hands, axis=2) / np.linalg.norm(forearms, axis=2) / np.linalg.norm(hands, axis=2)
    assert np.degrees(np.arccos(cosines.min())) < 85.0
    middles = body.layout.spine_count + 5 + 4 * np.arange(2)
    backs = [rotations[:, hand] @ [2.0 * side - 1.0, 0.0, 0.0] for side, hand in enumerate(middles)]
    lifted = rises[:, wrists + 1] > 0.02
    assert min(float(back[lifted[:, side], 2].min()) for side, back in enumerate(backs)) > 0.0
