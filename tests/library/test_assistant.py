"""Strikes that the example captures were made to have."""

from pathlib import Path

import pytest

from studio.core.normalized.normalize import normalize
from studio.core.normalized.realize import realize
from studio.io.importing import load_capture
from studio.library.assistant import propose
from studio.library.clips import ClipLabel, HitSegment, Kind, Limb

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"


def proposals(name):
    motion, actor = normalize(load_capture(EXAMPLES / f"{name}.bvh"))
    return propose(*realize(motion, actor.morphology, play=True), actor.morphology, motion.frame_rate)


@pytest.mark.parametrize(
    ("name", "limb", "time"), [("straight_punch", Limb.RIGHT_ARM, 3.0), ("front_kick", Limb.RIGHT_LEG, 2.56)]
)
def test_a_strike_is_found_when_it_was_made_to_hit(name, limb, time):
    (clip,) = proposals(name)
    assert clip.limb is limb
    assert clip.hit / 60.0 == pytest.approx(time, abs=0.1)
    assert clip.kind is (Kind.PUNCH if limb.is_arm else Kind.KICK)


@pytest.mark.parametrize("name", ["walk_turn", "reach_grasp"])
def test_walking_and_grasping_are_no_strikes(name):
    assert proposals(name) == []


def test_a_clip_hits_between_its_frames_with_a_segment_of_its_limb():
    with pytest.raises(ValueError, match="not in order"):
        ClipLabel(5, 20, 4, Limb.LEFT_ARM, Kind.PUNCH, HitSegment.FIST)
    with pytest.raises(ValueError, match="left arm has no heel"):
        ClipLabel(5, 20, 9, Limb.LEFT_ARM, Kind.PUNCH, HitSegment.HEEL)
