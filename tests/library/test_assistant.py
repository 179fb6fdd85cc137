"""Strikes that the example captures were made to have."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.normalized.mirror import mirrored_motion
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.io.importing import load_capture
from studio.library.clip_labels import ClipLabel, HitSegment, Kind, Limb
from studio.library.proposed_strikes import proposed_labels
from studio.resources_folder import bundled_strikes_folder

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"


def proposals(path):
    motion, actor = normalize_capture(load_capture(path))
    return proposed_labels(*realize_motion(motion, actor.morphology, play=True), actor.morphology, motion.frame_rate)


@pytest.mark.parametrize(
    ("name", "limb", "time"), [("straight_punch", Limb.RIGHT_ARM, 3.0), ("front_kick", Limb.RIGHT_LEG, 2.56)]
)
def test_a_strike_is_found_when_it_was_made_to_hit(name, limb, time):
    (clip,) = proposals(EXAMPLES / f"{name}.bvh")
    assert clip.limb is limb
    assert clip.hit / 60.0 == pytest.approx(time, abs=0.1)
    assert clip.kind is (Kind.PUNCH if limb.is_arm else Kind.KICK)


@pytest.mark.parametrize("name", ["walk_turn", "reach_grasp"])
def test_walking_and_grasping_are_no_strikes(name):
    assert proposals(EXAMPLES / f"{name}.bvh") == []


def legs_in_turn(seconds):
    """The front kick again and again, now with one leg and now with the other."""
    motion, actor = normalize_capture(load_capture(EXAMPLES / "front_kick.bvh"))
    points, turns = realize_motion(motion, actor.morphology, play=True)
    swing = slice(154 - round(30 * seconds), 154 + round(30 * seconds))
    other = realize_motion(mirrored_motion(motion), actor.morphology, play=True)
    legs = [(points[swing], turns[swing]), (other[0][swing], other[1][swing])] * 4
    whole = [np.concatenate(parts) for parts in zip(*legs, strict=True)]
    return proposed_labels(*whole, actor.morphology, motion.frame_rate)


def test_legs_that_swing_in_turn_to_a_beat_dance():
    assert len(legs_in_turn(1.5)) >= 6
    assert legs_in_turn(0.6) == []


def test_a_leg_that_stays_out_is_shown_and_kicks_nobody():
    motion, actor = normalize_capture(load_capture(EXAMPLES / "front_kick.bvh"))
    (kick,) = proposals(EXAMPLES / "front_kick.bvh")
    frames = np.insert(np.arange(motion.frame_count), kick.hit, [kick.hit] * 30)
    points, turns = realize_motion(motion, actor.morphology, play=True)
    assert proposed_labels(points[frames], turns[frames], actor.morphology, motion.frame_rate) == []


def test_a_clip_hits_between_its_frames_with_a_segment_of_its_limb():
    with pytest.raises(ValueError, match="not in order"):
        ClipLabel(5, 20, 4, Limb.LEFT_ARM, Kind.PUNCH, HitSegment.FIST)
    with pytest.raises(ValueError, match="left arm has no heel"):
        ClipLabel(5, 20, 9, Limb.LEFT_ARM, Kind.PUNCH, HitSegment.HEEL)


def test_every_bundled_strike_is_found_once():
    strikes = sorted(bundled_strikes_folder().glob("*.bvh"))
    assert [len(proposals(path)) for path in strikes] == [1] * len(strikes)
