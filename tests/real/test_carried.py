"""Real cartwheels, crawls and falls: hands, knees and seat stay on the ground on the five characters, without pops."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnimatedMorphology
from studio.core.captures.contacts import BODY_POINTS, ContactPoint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowTracked
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds import Bumps, Slope
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality, swing_depths
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.core.solver.task_assembly.tracks import Track
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import target
from tests.real.taken import HUMANS, RECORDINGS, contacts_of, named, taken
from tests.real.test_characters import FILES, read

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
CARRIED = {
    "crawl": {"left_hand", "right_hand", "left_knee", "right_knee"},
    "get_up": {"left_knee", "right_knee"},
    "cartwheel": {"left_hand", "right_hand"},
    "accad_female1_D6_CartWheel": {"left_hand", "right_hand"},
    "accad_female1_D5_RandomStuff2": {"left_hand", "right_hand"},
    "mass_cart": {"left_hand", "right_hand"},
    "accad_female1_A11_CrawlForward": {"left_hand", "right_hand", "left_knee", "right_knee", "seat"},
    "accad_female1_A08_CrouchToLie": {"left_hand", "right_hand", "seat"},
    "assimp_Boxing_Toes": {"left_hand", "right_hand", "seat"},
}


RECORDED = ["crawl", "get_up", "cartwheel"]
WHO = [*RECORDED, *outside(*(stem for stem in CARRIED if stem not in RECORDED))]
THREE = [*RECORDED, *outside("accad_female1_A11_CrawlForward", "accad_female1_A08_CrouchToLie", "mass_cart")]


def _points(stem: str) -> set[ContactPoint]:
    return {each.point for each in contacts_of(taken(named(stem))[0])} & set(BODY_POINTS)


@pytest.mark.parametrize("stem", WHO)
def test_what_touches_is_found(stem: str) -> None:
    assert _points(stem) == CARRIED[stem]


def test_who_stays_on_its_feet_touches_with_nothing_else(captures: Path) -> None:
    touching = {path.stem for path in HUMANS if _points(path.stem)}
    assert touching - set(CARRIED) <= {"accad_male2_G7_Capoeira"}


def test_who_is_recorded_on_the_feet_touches_with_nothing_else() -> None:
    assert {stem for stem in RECORDINGS if _points(stem)} == set(RECORDED)


def test_hands_of_a_cartwheel_come_down_one_after_the_other(captures: Path) -> None:
    contacts = contacts_of(taken(named("mass_cart"))[0])
    left, right = ([each for each in contacts if each.point.value == f"{side}_hand"] for side in ("left", "right"))
    assert (len(left), len(right)) == (1, 1)
    assert left[0].first < right[0].first < left[0].last < right[0].last


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("stem", WHO)
def test_what_stands_stays_and_nothing_pops(stem: str, name: str) -> None:
    capture, motion, actor = taken(named(stem))
    contacts = contacts_of(capture)
    adapted = adapt(AdaptRequest(motion, BODIES[name], contacts), capture.first_frame)
    quality = contact_quality(adapted, contacts, Ground())
    assert quality.slide < 1e-3
    assert quality.rise < 2e-3
    assert quality.penetration < 2e-3
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < 3.1


SLOPES = {
    "up": Slope(0.0, np.radians(15.0), -1.0, (-5.0, 8.0)),
    "aside": Slope(0.0, np.radians(15.0), 0.6, (-8.0, -5.0)),
    "down": Slope(0.0, np.radians(-15.0), 1.5, (0.0, -9.0)),
}


@pytest.mark.parametrize("slope", SLOPES)
@pytest.mark.parametrize("stem", THREE)
def test_cartwheels_and_crawls_hold_on_slopes(stem: str, slope: str) -> None:
    capture, motion, actor = taken(named(stem))
    contacts, source, ground = contacts_of(capture), source_motion(motion, actor), SLOPES[slope]
    for body in BODIES.values():
        adapted = adapt(AdaptRequest(motion, body, contacts, (), ground), capture.first_frame)
        quality = contact_quality(adapted, contacts, ground)
        assert quality.slide < 1e-3
        assert max(quality.rise, quality.penetration) < 2e-3
        assert acceleration_ratio(adapted, source) < 3.5  # of a giant uphill; of all others 3


@pytest.mark.parametrize("ground", [Ground(), SLOPES["down"], Bumps(0.0, 0.08, 1.2, 2)], ids=["floor", "down", "bumps"])
def test_feet_that_are_dragged_along_in_a_crawl_stay_out_of_the_ground(captures: Path, ground: Ground) -> None:
    capture, motion, _ = taken(named("accad_female1_A11_CrawlForward"))
    for body in BODIES.values():
        adapted = adapt(AdaptRequest(motion, body, contacts_of(capture), (), ground), capture.first_frame)
        assert np.nanmax(swing_depths(adapted, contacts_of(capture), ground)) < 2e-3


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("stem", THREE)
def test_who_crawls_lies_down_or_turns_a_cartwheel_holds_on_bumps(stem: str, seed: int) -> None:
    """Tucked toes, that lie where the ground turns off under them, within 13 mm; hands, knees and seat within 1."""
    capture, motion, actor = taken(named(stem))
    contacts, source, ground = contacts_of(capture), source_motion(motion, actor), Bumps(0.0, 0.08, 1.2, seed)
    others = [each for each in contacts if not each.point.is_foot]
    for body in BODIES.values():
        adapted = adapt(AdaptRequest(motion, body, contacts, (), ground), capture.first_frame)
        quality, whole = contact_quality(adapted, others, ground), contact_quality(adapted, contacts, ground)
        assert whole.slide < 1e-3
        assert max(quality.rise, quality.penetration) < 1e-3
        assert whole.rise < 2e-3
        assert whole.penetration < 13e-3
        assert acceleration_ratio(adapted, source) < 4.0


@pytest.mark.parametrize("path", FILES)
@pytest.mark.parametrize("stem", THREE)
def test_foreign_characters_keep_hands_knees_and_seat_on_the_ground(stem: str, path: Path) -> None:
    """Also those with arms longer than their legs."""
    capture, motion, _ = taken(named(stem))
    others = [each for each in contacts_of(capture) if not each.point.is_foot]
    adapted = adapt(AdaptRequest(motion, read(path).character.morphology, contacts_of(capture)), capture.first_frame)
    quality = contact_quality(adapted, others, Ground())
    assert quality.slide < 2e-3
    assert max(quality.rise, quality.penetration) < 2e-3


@pytest.mark.parametrize("stem", THREE)
def test_a_child_that_grows_into_a_giant_stays_on_what_carries_it(stem: str) -> None:
    capture, motion, actor = taken(named(stem))
    times = np.linspace(0.0, 1.0, motion.frame_count)
    body = AnimatedMorphology.from_bodies(BODIES["child"], BODIES["giant"], times * times * (3.0 - 2.0 * times))
    contacts = [each for each in contacts_of(capture) if each.point.member != "toe"]  # a foot that grows pushes its toe
    adapted = adapt(AdaptRequest(motion, body, contacts_of(capture)), capture.first_frame)
    quality = contact_quality(adapted, contacts, Ground())
    assert quality.slide < 1e-3
    assert max(quality.rise, quality.penetration) < 2e-3
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < 3.1


def test_bones_keep_their_lengths_while_hands_and_knees_carry(captures: Path) -> None:
    capture, motion, _ = taken(named("accad_female1_A11_CrawlForward"))
    body = BODIES["child"]
    points = adapt(AdaptRequest(motion, body, contacts_of(capture))).positions
    for side in range(2):
        for first, lengths in (
            (body.layout.hip_point(side), body.leg[side]),
            (body.layout.collar_point(side) + 1, body.arm[side]),
        ):
            for bone, length in enumerate(lengths):
                spans = np.linalg.norm(points[:, first + bone + 1] - points[:, first + bone], axis=1)
                assert np.allclose(spans, length, atol=1e-9)


def test_constraints_yield_to_hands_and_knees_and_scrubbing_is_playing(captures: Path) -> None:
    capture, motion, _ = taken(named("accad_female1_A11_CrawlForward"))
    contacts = contacts_of(capture)
    standing = ground_motion(motion, BODIES["adult_woman"], contacts, Ground())
    chest = BodyPoint(BodyPart.THORAX, at_end=True)
    place = body_point_positions(chest, solve_constraints(standing, ()))[270] + [0.0, 0.0, 0.12]
    curve = ActivationCurve(8.0, 9.0, 11.0, 12.0)
    lifted = target("thorax", place, Chain(trunk=1.0, root=1.0), activation=curve)
    moved = solve_constraints(standing, (lifted,))
    assert moved.residuals.shape == (1, motion.frame_count)
    assert moved.residuals[0, 270] < 0.08  # of 0.12, for hands and knees hold
    quality = contact_quality(moved, contacts, Ground())
    assert quality.slide < 1e-3
    assert quality.penetration < 2e-3
    window = solve_constraints(standing, (lifted,), 250, 290)
    assert np.array_equal(window.positions, moved.positions[250:291])


@pytest.mark.parametrize("name", ["adult_woman", "child", "giant"])
@pytest.mark.parametrize("stem", THREE)
def test_nothing_that_is_asked_elsewhere_moves_what_stands(stem: str, name: str) -> None:
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    standing = ground_motion(motion, BODIES[name], contacts, Ground())
    unsolved = solve_constraints(standing, ())
    for seed in range(6):
        random = np.random.default_rng(seed)
        wishes = []
        for priority in range(2):
            part = (BodyPart.HEAD, BodyPart.PELVIS, BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)[random.integers(4)]
            place = body_point_positions(BodyPoint(part, at_end=True), unsolved)[random.integers(motion.frame_count)]
            far = random.choice([0.05, 0.2, 0.6])
            chain = Chain(trunk=1.0, root=float(random.integers(2)))
            wishes.append(target(part.value, place + far * random.normal(size=3), chain, priority))
        assert contact_quality(solve_constraints(standing, wishes), contacts, Ground()).slide < 3e-4, seed


def test_the_head_of_who_crawls_goes_aside_beside_hands_knees_and_toes_that_stand(captures: Path) -> None:
    capture, motion, _ = taken(named("accad_female1_A11_CrawlForward"))
    standing = ground_motion(motion, BODIES["adult_woman"], contacts_of(capture), Ground())
    head, aside = BodyPoint(BodyPart.HEAD, at_end=True), FollowTracked("aside")
    places = body_point_positions(head, solve_constraints(standing, ())) + np.array([0.0, 0.05, 0.025])
    for chain in (Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)):
        wish = replace(target("head", places[0], chain), target=aside)
        missed = solve_constraints(standing, (wish,), tracks={aside: Track(places, np.eye(3)[None])}).residuals[0]
        assert np.quantile(missed, 0.95) < 1e-3


def test_a_target_for_a_hand_waits_until_the_hand_has_left_the_ground(captures: Path) -> None:
    capture, motion, _ = taken(named("mass_cart"))
    contacts = contacts_of(capture)
    wrist = target("left_forearm", (0.0, 0.0, 1.0), Chain())
    adapted = adapt(AdaptRequest(motion, BODIES["tall_man"], contacts, (wrist,)))
    hand = next(each for each in contacts if each.point is ContactPoint.LEFT_HAND)
    assert np.isnan(adapted.residuals[0, hand.first : hand.last + 1]).all()
    assert contact_quality(adapted, contacts, Ground()).slide < 1e-3
