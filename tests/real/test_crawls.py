"""Real crawls and planks: bodies keep the posture of who performed them, and do not fall on their bellies."""

from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactPoint
from studio.core.grounds import Slope
from studio.core.grounds.ground import Ground
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.quality.motion_quality import COMMON_LEG_METRES, MotionQuality, limb_elevations, motion_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from tests.captures import capture_file, outside
from tests.real.taken import RECORDINGS, contacts_of, named

BODIES: dict[str, Morphology | None] = {
    "actor": None,
    **{name: character.morphology for name, character in bundled_characters().items()},
}
FILES = {
    "recorded on all fours": ("crawl", 0, 205),
    "recorded kneeling": ("get_up", 0, 60),
    "recorded cartwheel": ("cartwheel", 0, 551),
    "plank": ("more_captures/accad_female1_D4_RandomStuff.bvh", 254, 271),
    "on the belly": ("more_captures/accad_male2_A11_Crawl.bvh", 0, 372),
    "on all fours": ("bvh/varied/accad_female1_A11_CrawlForward.bvh", 0, 500),
    "lying down": ("bvh/varied/accad_female1_A11_CrawlForward.bvh", 501, 600),
    "cartwheel": ("bvh/varied/mass_cart.bvh", 0, 285),
}


RECORDED = "recorded on all fours", "recorded kneeling", "recorded cartwheel"
KINDS = [*RECORDED, *outside(*(kind for kind in FILES if kind not in RECORDED))]
ALL_FOURS = ["recorded on all fours", *outside("on all fours")]


def _path(kind: str) -> Path:
    name = FILES[kind][0]
    return named(name) if name in RECORDINGS else capture_file(name)


@lru_cache
def _adapted(kind: str) -> tuple[AdaptedMotion, dict[str, AdaptedMotion], list[MotionQuality]]:
    """The source, the adapted motions, and their qualities."""
    capture = load_capture(_path(kind))
    motion, actor = normalize_capture(capture)
    contacts, source = contacts_of(capture), source_motion(motion, actor)
    own = actor.morphology
    adapted = {name: adapt(AdaptRequest(motion, body or own, contacts, actor=own)) for name, body in BODIES.items()}
    qualities = [motion_quality(each, source, contacts, Ground(), capture.first_frame) for each in adapted.values()]
    return source, adapted, qualities


def _turned(kind: str, name: str) -> NDArray[np.float64]:
    """(F, 9) degrees by which trunk, arms and legs rise otherwise than the source's, in the frames of that kind."""
    source, adapted, _ = _adapted(kind)
    _, first, last = FILES[kind]
    return np.asarray(np.degrees(np.abs(limb_elevations(adapted[name]) - limb_elevations(source)))[first : last + 1])


def _hips(motion: AdaptedMotion) -> NDArray[np.float64]:
    """(F,) metres of the hips above the ground on legs of 85 cm."""
    layout = motion.morphology.layout
    heights = motion.positions[:, [layout.hip_point(0), layout.hip_point(1)], 2].mean(axis=1)
    return np.asarray(heights * COMMON_LEG_METRES / motion.morphology.leg_length)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("kind", KINDS)
def test_trunk_and_legs_keep_their_posture(kind: str, name: str) -> None:
    """A knee that is dragged along and a leg that lies back pull nobody to the ground; long arms raise the trunk."""
    turned = _turned(kind, name)
    assert turned[:, 0].max() < 15.0
    assert turned[:, 5:].max() < 20.0


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(
    "kind",
    ["recorded on all fours", "recorded kneeling", *outside("plank", "on the belly", "on all fours", "lying down")],
)
def test_hips_are_no_higher_for_longer_arms(kind: str, name: str) -> None:
    """They were by 18 cm on legs of 85; floors that a capture has wrong are told from it by the median."""
    source, adapted, _ = _adapted(kind)
    _, first, last = FILES[kind]
    own, theirs = (_hips(motion)[first : last + 1] for motion in (adapted[name], source))
    assert np.abs(own - theirs - np.median(own - theirs)).max() < 0.06


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("kind", ["recorded on all fours", *outside("on the belly", "on all fours", "lying down")])
def test_arms_keep_their_posture_but_for_moments(kind: str, name: str) -> None:
    """Within 20 degrees, and twice that for a moment: bones of other lengths fold otherwise."""
    turned = _turned(kind, name)[:, 1:5].max(axis=1)
    assert turned.max() < 40.0
    assert (turned > 20.0).mean() < 0.15


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_jumps(kind: str) -> None:
    """A hand in the air pulls no body along, and has all the time that the actor's has for its way."""
    assert max(each.jump for each in _adapted(kind)[2]) < 2.0


@pytest.mark.parametrize("kind", ALL_FOURS)
def test_feet_of_knees_that_come_down_turn_as_smoothly_as_the_actors(kind: str) -> None:
    """They lie in line with their shanks: ankles bulged by 2 cm where knee and toe stood too near."""
    assert max(each.peaks["feet"] for each in _adapted(kind)[2]) < 2.0


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("kind", ALL_FOURS)
def test_no_elbow_is_in_the_ground(kind: str, name: str) -> None:
    """On bodies with longer arms they hung into it, of arms that reach ahead and of hands that stand."""
    _, adapted, _ = _adapted(kind)
    positions, layout = adapted[name].positions, adapted[name].morphology.layout
    for side in range(2):
        assert positions[:, layout.wrist_point(side) - 1, 2].min() > -0.005


SLOPES = {"up": 0.0, "across": np.pi / 2, "down": np.pi}


@pytest.mark.parametrize("name", ["tall_man", "giant"])
@pytest.mark.parametrize("way", SLOPES)
@pytest.mark.parametrize("kind", ALL_FOURS)
def test_on_a_slope_hands_stand_and_lie_along_it_and_do_not_jolt(kind: str, way: str, name: str) -> None:
    capture = load_capture(_path(kind))
    motion, actor = normalize_capture(capture)
    source = source_motion(motion, actor)
    ahead = source.positions[-1, 0] - source.positions[0, 0]
    direction = np.arctan2(ahead[1], ahead[0]) + SLOPES[way]
    begin = source.positions[0, 0, :2] - 99.0 * np.array([np.cos(direction), np.sin(direction)])
    ground, body = Slope(0.0, np.radians(15.0), direction, tuple(begin)), bundled_characters()[name].morphology
    standing = grounded_motion_of(AdaptRequest(motion, body, contacts_of(capture), (), ground, actor=actor.morphology))
    positions, rotations, layout = standing.positions[:], standing.rotations[:], body.layout
    for hold in standing.holds:
        if hold.point.member == "hand":
            wrist, hand = layout.wrist_point(hold.point.side), layout.spine_count + 5 + 4 * hold.point.side
            on, normals = hold.standing, hold.normals[hold.standing]
            assert positions[on, wrist] == pytest.approx(hold.places[on], abs=1e-3)
            fingers = rotations[on, hand] @ body.hand[hold.point.side]
            assert np.einsum("fk,fk->f", fingers, normals) == pytest.approx(0.0, abs=1e-3)
    adapted = AdaptedMotion(body, motion.frame_rate, 0, positions, rotations, np.empty((0, len(positions))))
    peaks = motion_quality(adapted, source, (), ground, capture.first_frame).peaks
    assert max(peaks["clavicles"], peaks["hands"]) < 2.2


def test_a_knee_that_is_dragged_along_does_not_stand(captures: Path) -> None:
    found = capture_contacts(load_capture(_path("on the belly")))
    knees = [*found[ContactPoint.LEFT_KNEE], *found[ContactPoint.RIGHT_KNEE]]
    assert all(last - first > 8 for first, last in knees)


def test_toes_stand_through_a_plank(captures: Path) -> None:
    """Though a knee comes down for a moment."""
    found = capture_contacts(load_capture(_path("plank")))
    for toe in (ContactPoint.LEFT_TOE, ContactPoint.RIGHT_TOE):
        assert any(first <= 254 and last >= 271 for first, last in found[toe])


def test_no_foot_is_flat_under_a_shank_that_lies(captures: Path) -> None:
    """It would show a floor 5 cm too low, and lift the whole body."""
    found = capture_contacts(load_capture(_path("on the belly")))
    assert not found[ContactPoint.LEFT_HEEL]
    assert not found[ContactPoint.RIGHT_HEEL]


@pytest.mark.parametrize("kind", ALL_FOURS)
def test_hands_stand_in_turn_all_along_a_crawl(kind: str) -> None:
    """One that rests at two places, with a slow way between them, rests at both."""
    found = capture_contacts(load_capture(_path(kind)))
    for hand in (ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND):
        spans = sorted(found[hand])
        assert all(later - last < 80 for (_, last), (later, _) in pairwise(spans))
