"""Feet of a body that comes in live: they stand where they came down, on the performer's ground, and nothing jumps.

Nothing is known of what comes next: the poses are given one after the other, as they come by VMC.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint, spans_of
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.grounds.slope import Slope
from studio.core.grounds.steps import Steps
from studio.core.kernels.support.sole import HEEL_STANDS, TOE_STANDS
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import LIMB_BONES, swing_depths, turning_peaks
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from studio.live.driving import ReceivedPose, driven_frame
from studio.live.live_grounding import LiveGrounding
from studio.live.streamer import packets_of
from studio.live.tracker import Inbox
from tests.core.motions import ALWAYS, walk
from tests.real.taken import named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
GROUNDS = {"floor": Ground(), "raised floor": Ground(0.3), "slope": Slope(), "steps": Steps()}
COME_DOWN = 0.15
"""Seconds after which a foot that has begun to stand is on the ground."""
STEMS = "accad_female1_B03_Walk1", "accad_male2_G2_FrontKick"
WALK = walk(40)[0]


@dataclass
class Played:
    """Poses received, on the sender's own body, and poses shown; ``stood`` names the standing points."""

    source: AdaptedMotion
    shown: AdaptedMotion
    stood: tuple[ContactInterval, ...]


def received(source: AdaptedMotion, frames: np.ndarray) -> list[NormalizedMotion]:
    """Frames of a body that were sent and came in."""
    inbox, poses = Inbox(), []
    pose = ReceivedPose(inbox)
    for frame in frames:
        for packet in packets_of(source.positions[frame], source.rotations[frame], source.morphology, 0.0):
            inbox.receive(packet)
        poses.append(pose())
    return poses


@lru_cache
def sent(stem: str) -> tuple[AdaptedMotion, tuple[NormalizedMotion, ...]]:
    """400 frames of a capture, at 60 Hz at most, and how they come in."""
    capture, motion, actor = taken(named(stem))
    source = source_motion(motion, actor)
    step = max(round(motion.frame_rate / 60.0), 1)
    frames = np.arange(capture.first_frame, motion.frame_count, step)[:400]
    known = AdaptedMotion(
        source.morphology,
        motion.frame_rate / step,
        0,
        source.positions[frames],
        source.rotations[frames],
        np.empty((0, len(frames))),
    )
    return known, tuple(received(source, frames))


@lru_cache
def play(stem: str, body: Morphology, ground: Ground) -> Played:
    source, poses = sent(stem)
    planted, shown, states = LiveGrounding(), [], []
    for frame, pose in enumerate(poses):
        shown.append(driven_frame(AdaptRequest(pose, body, ground=ground), 0, pose, planted, frame / source.frame_rate))
        states.append(planted.states)
    parts = (np.concatenate([getattr(each, name) for each in shown]) for name in ("positions", "rotations"))
    whole = AdaptedMotion(body, source.frame_rate, 0, *parts, np.empty((0, len(shown))))
    stood = [
        ContactInterval(stem, ContactPoint(f"{name}_{kind}"), *span)
        for side, name in enumerate(("left", "right"))
        for kind, bit in (("heel", HEEL_STANDS), ("toe", TOE_STANDS))
        for span in spans_of((np.array(states)[:, side] & bit) != 0)
    ]
    return Played(source, whole, tuple(stood))


@pytest.fixture(params=STEMS)
def stem(request, captures):
    return request.param


@pytest.fixture(params=["child", "giant"])
def body(request):
    return BODIES[request.param]


@pytest.fixture(params=GROUNDS)
def ground(request):
    return GROUNDS[request.param]


def come_down(played: Played) -> list[ContactInterval]:
    """Standing points, from when they have come down on."""
    later = round(COME_DOWN * played.shown.frame_rate)
    return [replace(each, first=each.first + later) for each in played.stood if each.last > each.first + later]


def test_heels_and_toes_that_stand_stay_where_they_came_down(stem, body, ground):
    played = play(stem, body, ground)
    slides, _ = contact_tracks(played.shown, come_down(played), ground)
    assert len(come_down(played)) >= 6
    assert np.nanmax(slides) < 1e-3


@pytest.mark.parametrize(
    ("stem", "ground"), [*((stem, name) for stem in STEMS for name in list(GROUNDS)[:3]), (STEMS[0], "steps")]
)
def test_what_stands_is_on_the_performers_ground_once_it_has_come_down(captures, stem, ground, body):
    played = play(stem, body, GROUNDS[ground])
    _, heights = contact_tracks(played.shown, come_down(played), GROUNDS[ground])
    assert np.nanmax(np.abs(heights)) < 4e-3


def test_feet_in_the_air_stay_out_of_a_level_floor(stem, body):
    played = play(stem, body, Ground())
    assert np.nanmax(swing_depths(played.shown, played.stood, Ground())) < 2e-3


def test_feet_that_come_down_or_roll_are_never_in_a_level_floor(stem, body):
    """A heel that came down behind its ball sank in by 15 mm on a child, and by 29 on a giant."""
    played = play(stem, body, Ground())
    _, heights = contact_tracks(played.shown, played.stood, Ground())
    assert np.nanmin(heights) > -4e-3


def test_limbs_turn_hardly_more_sharply_than_the_senders(stem, body, ground):
    played = play(stem, body, ground)
    ours, theirs = (turning_peaks(each)[LIMB_BONES, 1].max() for each in (played.shown, played.source))
    assert ours < 1.5 * theirs


def test_a_walk_stands_about_as_long_as_it_does_as_a_capture(captures):
    played = play(STEMS[0], BODIES["tall_man"], Ground())
    for side in range(2):
        stands = sum(
            each.last + 1 - each.first for each in played.stood if each.point.side == side and each.point.is_heel
        )
        assert 0.35 < stands / played.shown.frame_count < 0.65


def test_a_hand_that_is_asked_far_away_takes_no_foot_along():
    body = BODIES["adult_woman"]
    positions, rotations = realize_motion(WALK, body)
    source = AdaptedMotion(body, 60.0, 0, positions, rotations, np.empty((0, len(positions))))
    [pose] = received(source, np.array([20]))
    planted, wrist = LiveGrounding(), body.layout.wrist_point(1)
    stood = driven_frame(AdaptRequest(pose, body), 0, pose, planted, 0.0)
    place = stood.positions[0, wrist] + [0.5, 0.0, 0.0]
    point, chain = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), Chain(trunk=1.0, root=1.0)
    asked = PositionConstraint("walk", "Wrist", point, chain, 0, ALWAYS, target=tuple(place))
    reached = driven_frame(AdaptRequest(pose, body, constraints=(asked,)), 0, pose, planted, 0.1)
    for side, state in enumerate(planted.states):
        ankle = body.layout.ankle_point(side)
        assert not state or np.linalg.norm(reached.positions[0, ankle] - stood.positions[0, ankle]) < 1e-3
    assert any(planted.states)
    assert np.linalg.norm(reached.positions[0, 0] - stood.positions[0, 0]) > 0.05


def test_a_body_that_was_away_begins_anew_where_it_is(captures):
    _, poses = sent(STEMS[0])
    body, planted = BODIES["giant"], LiveGrounding()
    driven_frame(AdaptRequest(poses[0], body), 0, poses[0], planted, 0.0)
    late = driven_frame(AdaptRequest(poses[-1], body), 0, poses[-1], planted, 5.0)
    anew = driven_frame(AdaptRequest(poses[-1], body), 0, poses[-1], LiveGrounding(), 0.0)
    assert np.abs(late.positions - anew.positions).max() < 1e-12
