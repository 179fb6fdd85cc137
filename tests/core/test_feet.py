"""Feet and the pelvis above them: soles, heels and ends that rotate out of the ground."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import sole_rows
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.grounds.ground import Ground
from studio.core.kernels.support import foot_rotation as kernel
from studio.core.kernels.support import heel_roll
from studio.core.kernels.support.foot_anchoring import TIP_PIVOT_PITCH, anchor_ankles
from studio.core.kernels.support.gap_interpolation import fade_into_gaps, interpolate_gaps
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS, ball_above_heel, toe_heading
from studio.core.normalized.realize import realize_motion
from studio.core.rotations import to_matrix
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.foot_tipping import heights_of
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.grounding.held_foot import FootPath
from studio.core.solver.grounding.pelvis_tilt import MAX_OBLIQUITY, tilt_pelvis_to_feet
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.contact_release import contact_release
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology
from tests.core.motions import about, from_vectors, random_rotations, target, walk
from tests.core.twins import feet as twin

# Feet that stand: soles level, ankles and toes at one place; the kernels against twins and by laws.


seeds = st.integers(0, 2**32 - 1)
SOLE = twin.Sole(np.array([0.13, 0.0, -0.06]), 0.08, 0.05)
TOE_LENGTH = 0.06
MEASURES = np.array([[*SOLE.foot, SOLE.ankle_height, SOLE.heel_length, TOE_LENGTH]])
LEVEL = np.zeros(60)


class _Steps:
    """A foot that turns smoothly at random while it stands on heel, toe, both or neither."""

    def __init__(self, seed: int, frames: int = 60) -> None:
        random = np.random.default_rng(seed)
        times = np.arange(frames)[:, None] / 10
        vectors = [0.3, 0.4, 1.0] * np.sin(times * random.uniform(0.5, 2, 3) + random.uniform(0, 6, 3))
        self.rotations = to_matrix(from_vectors(vectors))
        self.toes = to_matrix(from_vectors(0.4 * np.sin(times + random.uniform(0, 6, 3))))
        self.ankles = np.cumsum(random.normal(size=(frames, 3)), axis=0) / 50 + [0, 0, 0.2]
        lengths = random.integers(1, 12, size=frames)
        self.states = np.repeat(random.integers(0, 4, size=frames), lengths)[:frames]
        self.ground = 0.1 * np.sin(times[:, 0])


def _levelled(steps: _Steps) -> np.ndarray:
    out = np.empty_like(steps.rotations)
    kernel.level_soles(steps.rotations, steps.states, twin.REACH, twin.FADE, out)
    return out


def _planted(steps: _Steps, feet: np.ndarray, pitches: np.ndarray = LEVEL) -> np.ndarray:
    out = np.empty_like(steps.ankles)
    anchor_ankles(steps.ankles, feet, steps.states, MEASURES, steps.ground, pitches, twin.REACH, twin.FADE, out)
    return out


@given(seeds)
def test_the_kernels_agree_with_their_twins(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    assert np.allclose(feet, twin.level_soles(steps.rotations, steps.states), atol=1e-9)
    toes = np.empty_like(feet)
    kernel.level_toes(feet, steps.toes, steps.states, LEVEL, twin.REACH, twin.FADE, toes)
    assert np.allclose(toes, twin.level_toes(feet, steps.toes, steps.states), atol=1e-9)
    planted = twin.plant_ankles(steps.ankles, feet, steps.states, SOLE, steps.ground)
    assert np.allclose(_planted(steps, feet), planted, atol=1e-12)
    values, known = steps.ankles.copy(), steps.states == 2
    interpolate_gaps(values, known)
    assert np.allclose(values, twin.fill_gaps(steps.ankles, known), atol=1e-12)


@pytest.mark.parametrize("roll", [-20.0, 0.0, 20.0])
def test_a_standing_toe_turns_little_by_little_while_its_foot_is_pitched_past_straight_down(roll: float) -> None:
    pitches = np.arange(20.0, 110.0, 0.5)
    feet = Rotation.from_euler("ZYX", [[30.0, pitch, roll] for pitch in pitches], degrees=True).as_matrix()
    headings = np.degrees(np.unwrap([np.arctan2(*toe_heading(foot)[::-1]) for foot in feet]))
    assert np.abs(np.diff(headings)).max() < 1.0


@given(seeds)
def test_a_flat_foot_is_level_and_looks_one_way(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    for stretch in twin.stretches(steps.states == twin.FLAT):
        assert np.allclose(feet[stretch, :, 2], [0.0, 0.0, 1.0], atol=1e-9)
        assert np.allclose(feet[stretch], feet[stretch[0]], atol=1e-9)


@given(seeds)
def test_what_stands_stays_where_it_is(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    ankles = _planted(steps, feet)
    toes = ankles + feet @ SOLE.foot
    heels = ankles + [SOLE.pad_below_ankle(foot) for foot in feet]
    for bit, track in ((twin.HEEL, heels), (twin.TOE, toes)):
        for stretch in twin.stretches((steps.states & bit) != 0):
            still = track[stretch, :2]
            assert np.allclose(still, still[0], atol=1e-9)


@given(seeds)
def test_the_lowest_of_heel_and_ball_lies_on_the_ground(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    ankles = _planted(steps, feet)
    for frame in np.flatnonzero(steps.states):
        heel, ball = SOLE.heel_below_ankle(feet[frame]), SOLE.ball_below_ankle(feet[frame])
        assert ankles[frame, 2] + min(heel[2], ball[2]) == pytest.approx(steps.ground[frame], abs=1e-12)


@given(seeds)
def test_toes_that_roll_and_turn_have_a_still_point_between_ball_and_tip_at_last_the_tip(seed: int) -> None:
    steps = _Steps(seed)
    steps.states = np.repeat([twin.FLAT, twin.TOE, 0], 20)
    steps.rotations[:] = Rotation.from_rotvec(
        np.outer(0.1 * np.maximum(np.arange(60) - 20.0, 0.0), [0.0, 0.0, 1.0])
    ).as_matrix()
    pitches = np.where(steps.states == twin.TOE, 0.9 * np.clip((np.arange(60) - 24) / 12, 0.0, 1.0), 0.0)
    toes = np.empty_like(steps.toes)
    kernel.level_toes(steps.rotations, steps.toes, steps.states, pitches, twin.REACH, twin.FADE, toes)
    balls = _planted(steps, steps.rotations, pitches) + steps.rotations @ SOLE.foot
    thick = SOLE.ankle_height + SOLE.foot[2]
    tips = balls + toes @ [TOE_LENGTH, 0.0, -thick]
    assert np.allclose(balls[:25, :2], balls[0, :2], atol=1e-9)
    of_balls, of_tips = np.diff(balls[:40, :2], axis=0), np.diff(tips[:40, :2], axis=0)
    change = of_tips - of_balls
    squares = (change**2).sum(axis=1)
    along = np.clip(-(of_balls * change).sum(axis=1) / np.where(squares > 0.0, squares, 1.0), 0.0, 1.0)
    assert np.allclose(of_balls + along[:, None] * change, 0.0, atol=1e-9)
    on_tips = pitches[:40] > TIP_PIVOT_PITCH
    assert np.allclose(of_tips[on_tips[1:] & on_tips[:-1]], 0.0, atol=1e-9)
    assert np.allclose(tips[:40, 2], steps.ground[:40], atol=1e-9)
    assert balls[39, 2] - thick > steps.ground[39] + 0.5 * TOE_LENGTH


@given(seeds)
def test_a_foot_tilted_the_wrong_way_is_put_down_and_a_right_one_left_alone(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    kept = feet.copy()
    kernel.limit_foot_pitch(MEASURES, steps.states, twin.REACH, twin.FADE, kept)
    for frame in np.flatnonzero(steps.states):
        before, after = (SOLE.ball_below_ankle(r)[2] - SOLE.heel_below_ankle(r)[2] for r in (feet[frame], kept[frame]))
        state = steps.states[frame]
        right = state == twin.FLAT or (before >= 0.0) == (state == twin.HEEL)
        if right:
            assert np.allclose(kept[frame], feet[frame], atol=1e-12)
        else:
            assert after == pytest.approx(0.0, abs=1e-3)


@given(seeds)
def test_how_the_ball_lies_above_the_heel_is_told_by_geometry(seed: int) -> None:
    rotation = random_rotations(np.random.default_rng(seed))
    rise = SOLE.ball_below_ankle(rotation)[2] - SOLE.heel_below_ankle(rotation)[2]
    found = ball_above_heel(rotation, MEASURES[0])
    assert found == pytest.approx(rise, abs=1e-12)


def test_a_foot_that_never_stands_is_left_as_it_is() -> None:
    steps = _Steps(0)
    steps.states[:] = 0
    assert np.allclose(_levelled(steps), steps.rotations, atol=1e-15)
    assert np.array_equal(_planted(steps, steps.rotations), steps.ankles)


def test_the_way_between_two_stands_has_no_corner() -> None:
    """Position, velocity and acceleration pass over both ends of a gap without a jump."""
    known = np.ones(90, dtype=bool)
    known[30:60] = False
    values = np.zeros((90, 3))
    values[60:] = 1.0
    interpolate_gaps(values, known)
    acceleration = np.diff(values[:, 0], 2)
    assert np.abs(np.diff(values[:, 0])).max() < 2.0 / 30
    assert np.abs(np.diff(acceleration)).max() < 3 * np.abs(acceleration).max() * 2 * np.pi / 30


def test_what_comes_to_rest_on_the_ground_and_starts_from_it_changes_its_speed_in_many_small_steps() -> None:
    """A foot that goes on and on, and its place on the ground: no frame takes all of its speed at once."""
    frames, reach = np.arange(90), 12.0
    known = (frames >= 30) & (frames < 60)
    track = 0.01 * np.column_stack([frames, frames, frames])
    values = np.where(known[:, None], track[45] - track, 0.0)
    fade_into_gaps(values, known, track, reach, reach)
    speeds = np.diff((track + values)[:, 0])
    assert np.allclose(speeds[30:59], 0.0, atol=1e-12)
    assert np.abs(np.diff(speeds)).max() < 0.4 * 0.01


@given(st.integers(4, 40), st.floats(0.0, 0.2), st.floats(1e-4, 0.02), seeds)
def test_a_fading_correction_adds_half_of_the_motions_own_acceleration_or_fades_in_its_least_time(
    gap: int, size: float, own: float, seed: int
) -> None:
    """It is interpolated at worst, and gone where there is time."""
    least, begin = 8.0, np.random.default_rng(seed).normal(size=3)
    known = np.ones(20 + gap, dtype=bool)
    known[10 : 10 + gap] = False
    values = np.where(np.arange(20 + gap)[:, None] < 10, size * begin / np.linalg.norm(begin), 0.0)
    track = np.zeros((20 + gap, 3))
    track[:, 0] = 0.5 * own * np.arange(20 + gap) ** 2
    faded, interpolated = values.copy(), values.copy()
    fade_into_gaps(faded, known, track, least, least)
    interpolate_gaps(interpolated, known)
    assert (np.linalg.norm(faded, axis=1) <= np.linalg.norm(interpolated, axis=1) + 1e-12).all()
    added = np.linalg.norm(np.diff(faded, 2, axis=0), axis=1).max(initial=0.0)
    slowest = np.linalg.norm(np.diff(interpolated, 2, axis=0), axis=1).max(initial=0.0)
    assert added <= max(0.5 * own, slowest, 6.0 * size / least**2) + 1e-12


@given(seeds)
def test_corrections_that_need_not_fade_are_interpolated(seed: int) -> None:
    random = np.random.default_rng(seed)
    known = np.repeat(random.random(12) < 0.5, 5)
    values = np.repeat(random.normal(size=(12, 3)), 5, axis=0)
    faded, interpolated = values.copy(), values.copy()
    fade_into_gaps(faded, known, values, 8.0, np.inf)
    interpolate_gaps(interpolated, known)
    assert np.allclose(faded, interpolated, atol=1e-12)


# Heels that rise over a ball that stands.


SOLE_MEASURES = np.array([[0.13, 0.0, -0.05, 0.08, 0.05, 0.06]])
"""Ankle to toe joint, ankle above the sole, heel behind the ankle, length of the toe."""
STATES = np.repeat([SOLE_STANDS, TOE_STANDS, 0, SOLE_STANDS], [30, 30, 30, 30])
RISE = np.where(STATES == TOE_STANDS, 0.04 * np.clip((np.arange(120) - 30) / 20, 0.0, 1.0), 0.0)


def _level() -> np.ndarray:
    return to_matrix(about([0.0, 1.0, 0.0], np.zeros(120)))


def _ankles(rotations: np.ndarray) -> np.ndarray:
    """Heights of the ankle over a sole whose ball stands."""
    return SOLE_MEASURES[0, 3] + SOLE_MEASURES[0, 2] - rotations[:, 2] @ SOLE_MEASURES[0, :3]


def test_an_ankle_is_as_high_as_the_motion_has_it_soon_after_its_heel_left_the_ground() -> None:
    rotations = _level()
    heel_roll.lift_heels(SOLE_MEASURES, STATES, SOLE_MEASURES[0, 3] + RISE, 10.0, 10.0, rotations)
    assert np.allclose(_ankles(rotations)[:30], SOLE_MEASURES[0, 3], atol=1e-12)
    assert np.allclose(_ankles(rotations)[45:60], SOLE_MEASURES[0, 3] + RISE[45:60], atol=0.1 * 0.04)


def test_the_ankle_of_a_foot_that_becomes_steep_rises_ever_more_slowly_as_captured() -> None:
    """The foot pitches to 65 degrees: an ankle that went its own way from some pitch on would straighten the knee."""
    pitches = np.radians(65.0) * np.where(STATES == TOE_STANDS, np.clip((np.arange(120) - 29) / 30, 0.0, 1.0), 0.0)
    steep, captured = (to_matrix(about([0.0, 1.0, 0.0], fraction * pitches)) for fraction in (1.0, 0.8))
    heel_roll.lift_heels(SOLE_MEASURES, STATES, _ankles(captured), 10.0, 10.0, steep)
    assert (np.diff(_ankles(captured)[45:60], 2) < 0.0).all()
    assert (np.diff(_ankles(steep)[45:60], 2) < 0.0).all()


def test_a_contact_in_which_no_heel_stands_is_left_as_it_is() -> None:
    """A body that kneels or lies rolls over nothing."""
    states = np.where(STATES == SOLE_STANDS, 0, STATES)
    rotations = _level()
    heel_roll.lift_heels(SOLE_MEASURES, states, SOLE_MEASURES[0, 3] + RISE, 10.0, 10.0, rotations)
    assert np.array_equal(rotations, _level())


def _roll(states: np.ndarray, hips: np.ndarray, reaches: np.ndarray, ankles: np.ndarray, rotations: np.ndarray) -> None:
    pitches = np.empty((120, 2))
    heel_roll.find_roll_pitches(SOLE_MEASURES, states, hips, reaches, ankles, rotations, pitches)
    heel_roll.roll_feet(SOLE_MEASURES, states, pitches, 10.0, ankles, rotations)


@pytest.mark.parametrize("miss", [0.0, 0.005, 0.02, 0.05])
def test_a_foot_rolls_on_where_its_leg_is_too_short_and_its_ball_stays(miss: float) -> None:
    rotations, ankles = _level(), np.tile([0.0, 0.0, SOLE_MEASURES[0, 3]], (120, 1))
    hips = np.tile([0.4, 0.0, 0.8], (120, 1))
    reaches = np.full(120, np.linalg.norm(hips[0] - ankles[0]) - miss)
    balls = ankles + rotations @ SOLE_MEASURES[0, :3]
    _roll(STATES, hips, reaches, ankles, rotations)
    assert np.allclose((ankles + rotations @ SOLE_MEASURES[0, :3])[STATES != 0], balls[STATES != 0], atol=1e-12)
    lacks = np.linalg.norm(hips - ankles, axis=1) - reaches
    assert np.allclose(lacks[:30], miss, atol=1e-12)
    assert lacks[50:60].max() < 0.35 * miss + 1e-9


@pytest.mark.parametrize("miss", [0.0, 0.005, 0.02])
def test_a_foot_that_lands_rolls_back_over_its_heel_where_its_leg_is_too_short(miss: float) -> None:
    states = np.repeat([0, HEEL_STANDS, SOLE_STANDS, 0], 30)
    rotations, ankles = _level(), np.tile([0.0, 0.0, SOLE_MEASURES[0, 3]], (120, 1))
    hips = np.tile([-0.4, 0.0, 0.8], (120, 1))
    reaches = np.full(120, np.linalg.norm(hips[0] - ankles[0]) - miss)
    edge = [-SOLE_MEASURES[0, 4], 0.0, -SOLE_MEASURES[0, 3]]
    _roll(states, hips, reaches, ankles, rotations)
    assert np.allclose((ankles + rotations @ edge)[30:90], edge + np.array([0.0, 0.0, SOLE_MEASURES[0, 3]]), atol=1e-12)
    lacks = np.linalg.norm(hips - ankles, axis=1) - reaches
    assert np.allclose(lacks[60:90], miss, atol=1e-12)
    assert lacks[30:50].max() < 0.35 * miss + 1e-9


def test_a_ball_that_has_risen_stands_on_the_tip_of_its_toes() -> None:
    pitches = np.empty(120)
    heel_roll.tiptoe_pitches(SOLE_MEASURES, STATES, RISE, 10.0, pitches)
    assert not pitches[STATES != TOE_STANDS].any()
    assert 0.3 < pitches[59] < heel_roll.STEEPEST_TOE_PITCH
    heel_roll.tiptoe_pitches(SOLE_MEASURES, STATES, 0.1 * RISE, 10.0, pitches)
    assert not pitches.any()


# Feet and hands that constraints take into the ground rotate out of it; ankle and wrist still meet their targets.


WALK, CONTACTS = walk(120)
WHOLE_CHAIN = Chain(trunk=1.0, root=1.0)


def standing_on(body: str) -> GroundedMotion:
    return ground_motion(WALK, bundled_characters()[body].morphology, CONTACTS, Ground())


def sole_heights(solved: AdaptedMotion, side: int) -> NDArray[np.float64]:
    layout = solved.morphology.layout
    foot = FootPath(
        solved.positions[:, layout.ankle_point(side)],
        solved.rotations[:, layout.foot_segment(side)],
        solved.rotations[:, layout.toe_segment(side)],
    )
    return np.asarray(heights_of(foot, sole_rows(solved.morphology, side), Ground()).min(axis=0))


@pytest.mark.parametrize("body", ["child", "giant"])
@pytest.mark.parametrize("aside", [-0.1, 0.05])
def test_a_foot_led_low_over_the_ground_stays_above_it_and_its_ankle_is_met(body: str, aside: float) -> None:
    standing = standing_on(body)
    before, ankle = solve_constraints(standing, ()), BodyPoint(BodyPart.LEFT_SHANK, at_end=True)
    path = body_point_positions(ankle, before)
    place = path[int(path[:, 2].argmax())] + [0.0, aside, 0.0]
    place[2] = 0.15 * standing.morphology.leg_length
    wanted = target("left_shank", place, Chain(), 0)
    solved = solve_constraints(standing, (wanted,))
    lower = np.minimum(sole_heights(before, 0), 0.0) - sole_heights(solved, 0)
    assert lower.max() < 0.002
    released = contact_release((wanted,), standing)[0] == 1.0
    residuals = solved.residuals[0][released]
    assert np.linalg.norm(body_point_positions(ankle, solved) - place, axis=1)[released] == pytest.approx(
        residuals, abs=1e-6
    )
    assert residuals.min() < 1e-4


def test_a_hand_led_low_over_the_ground_bends_up_at_its_wrist() -> None:
    standing = standing_on("child")
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    before = solve_constraints(standing, ())
    place = body_point_positions(wrist, before)[60]
    place[2] = 0.03
    solved = solve_constraints(standing, (target("left_forearm", place, WHOLE_CHAIN, 0),))
    tips = solved.positions[:, standing.morphology.layout.wrist_point(0) + 1, 2]
    met = solved.residuals[0] < 1e-3
    assert met.any()
    assert tips[met].min() > -0.001


def test_a_foot_with_a_target_of_its_own_below_the_ground_is_brought_to_the_ground() -> None:
    standing = standing_on("child")
    toes = BodyPoint(BodyPart.LEFT_TOE, at_end=True)
    before = solve_constraints(standing, ())
    frame = int(body_point_positions(BodyPoint(BodyPart.LEFT_SHANK, at_end=True), before)[:, 2].argmax())
    place = body_point_positions(toes, before)[frame]
    place[2] = -0.03
    solved = solve_constraints(standing, (target("left_toe", place, Chain(), 0),))
    assert body_point_positions(toes, solved)[frame] == pytest.approx([place[0], place[1], 0.0], abs=2e-4)


# A pelvis that dips where two standing feet ask hips of different heights.


BODY = make_morphology(leg_scale=1.1)


def dipped(lower: float, states: np.ndarray) -> tuple[np.ndarray, ...]:
    """Hips' moves, and positions and rotations before and after, where right feet stand ``lower`` metres."""
    positions, rotations = realize_motion(WALK, BODY)
    before, turned = positions.copy(), rotations.copy()
    off = np.zeros((2, 120, 3))
    off[1, :, 2] = -lower
    return (
        tilt_pelvis_to_feet(off, states, BODY, WALK.frame_rate, positions, rotations),
        before,
        turned,
        positions,
        rotations,
    )


@given(st.floats(-0.1, 0.1))
def test_a_pelvis_dips_to_the_foot_that_stands_lower_and_bends_nothing_else(lower: float) -> None:
    moved, before, turned, positions, rotations = dipped(lower, np.full((2, 120), 3))
    assert (np.sign(moved[0, :, 2] - moved[1, :, 2]) == np.sign(np.round(lower, 12))).all() or abs(lower) < 1e-9
    assert np.array_equal(rotations[:, 1:], turned[:, 1:])
    between = np.einsum("fji,fjk->fik", turned[:, 0], rotations[:, 0])
    assert (
        np.arccos(np.clip((np.trace(between, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)) < MAX_OBLIQUITY + 1e-6
    ).all()
    hips = [BODY.layout.hip_point(side) for side in range(2)]
    for side, hip in enumerate(hips):
        assert np.allclose(positions[:, hip : hip + 5] - before[:, hip : hip + 5], moved[side, :, None], atol=1e-12)
        in_pelvis = np.einsum("fji,fj->fi", rotations[:, 0], positions[:, hip] - positions[:, 0])
        assert np.allclose(in_pelvis, np.einsum("fji,fj->fi", turned[:, 0], before[:, hip] - before[:, 0]), atol=1e-12)
    lumbar = np.linalg.norm(positions[:, 1] - positions[:, 0], axis=1)
    assert np.allclose(lumbar, np.linalg.norm(before[:, 1] - before[:, 0], axis=1), atol=1e-12)


def test_a_pelvis_over_feet_that_do_not_both_stand_stays_as_it_is() -> None:
    one = np.full((2, 120), 3)
    one[0] = 0
    _, before, turned, positions, rotations = dipped(0.05, one)
    assert np.array_equal(positions, before)
    assert np.array_equal(rotations, turned)
