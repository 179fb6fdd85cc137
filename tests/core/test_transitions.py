"""Transitions between clips, layers over them, and rows side by side."""

import math
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.pose import PoseSequence
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.layers import PlayedLayer, columns_of, with_layers
from studio.core.normalized.pieces import MotionPiece
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.resample import ResampledMotion
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import contact_quality, swing_depths
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.held_foot import FootPath, HeldFoot, heel_pivot
from studio.core.solver.grounding.inertialisation import Stance, inertialised_motion
from studio.core.solver.grounding.stepping import FootFlight, flights_of
from studio.core.stage.clip import Clip
from studio.core.stage.layer import Layer, Region
from studio.core.stage.project import Performer
from studio.core.stage.staging import (
    PERFORMER_SPACING,
    is_unarranged,
    next_row_position,
    performers_in_row,
    travel_heading,
)
from tests.builders import make_capture
from tests.core.test_compose import BODY, EXAMPLES, PERMITTED, cut, example, local_accelerations, peaks, standing

# Clips that take over from one another on the timeline, by chance: as smooth as the clips, on feet that stay.


COUNT = 32


def picked() -> list[tuple[MotionPiece, MotionPiece]]:
    """Two clips from any of their frames on, that leave a gap, meet, or overlap by up to a second."""
    chance = np.random.default_rng(19)
    found = []
    for index in range(COUNT):
        first, second = (example(str(name)) for name in chance.choice(EXAMPLES, 2))
        last, begin = int(chance.integers(70, first.last)), int(chance.integers(0, second.last - 70))
        before = cut(first, first=max(last - 150, 0), last=last)
        overlap = (0.0, -chance.uniform(0.2, 1.5), chance.uniform(0.2, 1.0))[index % 3]
        after = cut(second, first=begin, last=min(begin + 150, second.last), start=before.end - overlap)
        found.append((before, after))
    return found


class Transition(NamedTuple):
    """Greatest acceleration of joints beside the two captures; metres by which standing feet slide, feet are in the
    ground, and hips come lower than in both.
    """

    jolt: float
    slide: float
    depth: float
    sink: float


def lowest(piece: MotionPiece) -> float:
    """Metres over the ground that hips come down to in a clip alone."""
    alone = compose_pieces((replace(piece, start=0.0),))
    return float(standing(alone).positions[piece.first : piece.last + 1, 0, 2].min())


@cache
def by_chance() -> list[Transition]:
    """Figures of each of the ``picked``."""
    found = []
    for before, after in picked():
        row = compose_pieces((before, after))
        stands = standing(row)
        names = [each.motion.name for each in (before, after)]
        usual = np.maximum(np.maximum(*(peaks(name) for name in names)), QUIET_PEAK)
        adapted = solve_constraints(stands, ())
        quality = contact_quality(adapted, adapted.contacts, Ground())
        deep = float(np.nanmax(swing_depths(adapted, adapted.contacts, Ground()), initial=0.0))
        jolt = float((local_accelerations(stands).max(axis=0) / usual).max())
        sink = min(lowest(each) for each in (before, after)) - float(stands.positions[:, 0, 2].min())
        found.append(Transition(jolt, quality.slide, max(quality.penetration, deep), sink))
    return found


def test_of_clips_that_take_over_at_any_frame_few_are_sharper_than_permitted_and_none_jolts() -> None:
    """Of 60 by chance 16 were, 16 times as sharp at most."""
    jolts = np.array([each.jolt for each in by_chance()])
    assert np.mean(jolts > PERMITTED) < 1.0 / 6.0
    assert jolts.max() < 5.0


def test_no_foot_slides_nor_goes_into_the_ground_where_clips_take_over_at_any_frame() -> None:
    """Feet slid by up to half a metre. One whose toes come down in the very frame still settles by some millimetres."""
    slides, depths = (np.array([getattr(each, name) for each in by_chance()]) for name in ("slide", "depth"))
    assert np.mean(slides > 1e-3) < 1.0 / 16.0
    assert slides.max() < 5e-3
    assert depths.max() < 6e-3


def test_nobody_crouches_where_clips_take_over_at_any_frame() -> None:
    """Hips sank by up to two thirds of the leg for feet that had gone ahead of them, or that had stayed behind."""
    assert max(each.sink for each in by_chance()) < 0.1 * BODY.leg_length


def test_no_body_is_turned_round_for_a_foot_to_stand_where_it_stood() -> None:
    """Of 90 walks, kicks and punches 10 were, by more than a quarter turn: in another stride hips lie behind a foot."""
    for before, after in picked():
        row = compose_pieces((before, after))
        _, rotations = realize_motion(row.motion, BODY)
        ahead = rotations[:, 0, :2, 0]
        for change in row.motion.changes:
            assert ahead[change.first] @ ahead[change.first - 1] > 0.0


def test_who_goes_on_the_other_way_round_turns_there_in_one_way() -> None:
    """The shorter way once changed between the two frames that were seen, the body spun by half a turn a frame."""
    stands, first = standing(compose_pieces((example("walk_turn"),))), 60
    own = Stance.before(stands, first)
    around = turning_about(np.array([0.0, 0.0, 1.0]), np.array([np.pi - 0.01, np.pi + 0.01]))
    middle = own.positions[:, :1] * [1.0, 1.0, 0.0]
    places = (own.positions - middle) @ np.swapaxes(around, 1, 2) + middle
    seen = replace(
        own,
        positions=places,
        rotations=around[:, None] @ own.rotations,
        ankles=np.einsum("fij,sfj->sfi", around, own.ankles - middle[:, 0]) + middle[:, 0],
        feet=around @ own.feet,
        toes=around @ own.toes,
    )
    pelvis = inertialised_motion(stands, first, seen).rotations[first - 1 :, 0]
    steps = Rotation.from_matrix(pelvis[1:] @ np.swapaxes(pelvis[:-1], 1, 2)).magnitude()
    assert steps.max() * stands.motion.frame_rate < 4.0 * np.pi


def feet_of(piece: MotionPiece, frame: int) -> set[str]:
    return {each.point.value for each in piece.contacts if each.point.is_foot and each.first <= frame <= each.last}


@pytest.mark.parametrize("name", EXAMPLES[1:])
def test_of_an_overlap_no_frame_is_taken_in_which_other_feet_stand_than_at_its_ends(name: str) -> None:
    walk, other = example("walk_turn"), example(name)
    before = cut(walk, last=190)
    row = compose_pieces((before, cut(other, first=90, last=300, start=before.end - 1.0)))
    unlike = [len(feet_of(walk, frame) ^ feet_of(other, own_frame(row, frame))) for frame in range(130, 191)]
    assert unlike[row.motion.changes[0].first - 130] <= min(unlike[0], unlike[-1])


def own_frame(row: Composite, frame: int) -> int:
    return int(np.rint(row.played[1].motion_frames(np.array([frame]), row.timing))[0])


def test_no_frame_of_the_later_clip_comes_at_another_time() -> None:
    before, after = example("front_kick"), example("straight_punch")
    row = compose_pieces((before, cut(after, start=before.end - 0.9)))
    first = row.motion.changes[0].first
    placed = row.played[1]
    frames = np.arange(first, placed.last + 1)
    own = np.rint(placed.motion_frames(frames, row.timing)).astype(int)
    np.testing.assert_allclose(row.motion.channels[frames, 40:], after.motion.channels[own, 40:], atol=1e-12)


def turning_about(axis: np.ndarray, angles: np.ndarray) -> np.ndarray:
    c, s, zero = np.cos(angles), np.sin(angles), 0.0 * angles
    return np.moveaxis(np.array([[c, -s, zero], [s, c, zero], [zero, zero, zero + 1.0]]), 2, 0)


def test_a_foot_that_is_held_while_its_own_motion_walks_on_does_not_slide() -> None:
    """It slid by 57 mm where its own turned on its heel after a stride."""
    states = np.repeat([3, 0, 1], [20, 10, 30])
    frames = np.arange(60)
    sole = np.array([[0.13, 0.0, -0.06, 0.08, 0.05, 0.06]])
    turns = turning_about(np.array([0.0, 0.0, 1.0]), np.clip(frames - 30, 0, 30) / 30.0)
    came_down = np.clip((frames - 20) / 10.0, 0.0, 1.0)[:, None] * [0.8, 0.0, 0.0]
    own = FootPath(came_down - heel_pivot(sole).offsets(turns, turns), turns, turns)
    across = turning_about(np.array([0.0, 0.0, 1.0]), np.full(2, 1.2))
    seen = FootPath(np.tile([0.3, 0.2, 0.08], (2, 1)), across, across)
    foot = HeldFoot(own, states, seen, 3, sole, np.full(2, 100.0), 60.0)
    path, _ = foot.path(FootFlight(60, 60, 0.3, held=True), 0.3, np.arange(1, 61) / 60.0)
    heels = path.places(heel_pivot(sole))[31:]
    assert np.linalg.norm(heels - heels[0], axis=1).max() < 1e-9


def pitched(angle: float) -> np.ndarray:
    """Rotations (60, 3, 3) that point the x axis down by ``angle`` radians."""
    return np.tile(Rotation.from_euler("y", angle).as_matrix(), (60, 1, 1))


@pytest.mark.parametrize(("before", "after"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.3)])
def test_the_tip_of_a_foot_stays_where_it_is_while_its_toes_take_another_pitch(before: float, after: float) -> None:
    """It moved by 7 mm where the ball was held, which goes round the tip."""
    sole, tip = np.array([[0.13, 0.0, -0.06, 0.08, 0.05, 0.06]]), np.array([0.4, 0.1, 0.0])
    own, seen = (
        FootPath(tip - (pitched(angle + 0.3) @ [0.13, 0.0, -0.06] + pitched(angle) @ [0.06, 0.0, -0.02]), *turns)
        for angle, turns in ((each, (pitched(each + 0.3), pitched(each))) for each in (after, before))
    )
    seen = FootPath(seen.ankles[:2], seen.feet[:2], seen.toes[:2])
    foot = HeldFoot(own, np.full(60, 2), seen, 2, sole, np.full(2, 100.0), 60.0)
    path, _ = foot.path(FootFlight(60, 60, 0.3, held=True), 0.3, np.arange(1, 61) / 60.0)
    tips = path.ankles + path.feet @ [0.13, 0.0, -0.06] + path.toes @ [0.06, 0.0, -0.02]
    assert np.linalg.norm(tips - tip, axis=1).max() < 1e-9


def test_a_foot_that_is_lifted_at_once_is_in_the_air_from_the_change_on() -> None:
    """It had to lie as it does by itself, on the tip of its toes, within a frame or two, 13 times as sharp as ever."""
    other, own = np.full(140, 3), np.repeat([2, 0, 3], [2, 30, 108])
    flight, _ = flights_of(np.array([own, other]), np.array([2, 3]), np.zeros(2), np.full((2, 2), 0.3), 0.0, 60.0)
    assert not flight.held
    assert flight.leaves == 0


def test_a_step_is_as_fast_as_the_other_foot_stands_long() -> None:
    """One that found no time to step stood until its leg did not reach any more."""
    other, own = np.repeat([3, 0, 3], [60, 20, 60]), np.full(140, 3)
    _, step = flights_of(
        np.array([other, own]), np.array([3, 3]), np.array([0.0, 0.4]), np.full((2, 2), 0.3), 0.0, 60.0
    )
    assert step.leaves < 20
    assert step.leaves + round(step.seconds * 60.0) <= 60


def test_a_foot_that_comes_down_in_the_last_frame_does_not_stand_yet() -> None:
    """Its heel slid by 65 mm as it turned on: what moves between the two frames that are seen does not stand."""
    stands = standing(compose_pieces((example("walk_turn"),)))
    lands = [int(np.flatnonzero(np.diff((states != 0).astype(int)) > 0)[0]) + 1 for states in stands.footing.states]
    for side, frame in enumerate(lands):
        assert stands.footing.states[side, frame] != 0
        assert Stance.of(stands, np.array([frame - 1, frame])).states[side] == 0
        assert Stance.of(stands, np.array([frame, frame + 1])).states[side] != 0


def test_who_would_have_to_wait_for_long_to_step_hops() -> None:
    """The body went on, and fell by more than its legs are long for a foot that waited for the other to stand."""
    other, own = np.repeat([3, 0, 3], [57, 80, 111]), np.repeat([3, 0, 3], [148, 14, 86])
    needed = np.array([[0.3, 0.2], [1.0, 0.2]]).T
    flight, _ = flights_of(np.array([own, other]), np.array([3, 3]), np.array([0.6, 0.0]), needed.T, 0.0, 120.0)
    assert flight.leaves <= 24


def test_a_foot_in_the_air_lands_on_the_short_stances_of_a_run_too() -> None:
    """It was in the air to the end of the clip: no stance was long enough to land on."""
    own = np.repeat([0, 3, 0, 3, 0], [5, 16, 60, 14, 5])
    flight, _ = flights_of(np.array([own, own]), np.array([0, 0]), np.zeros(2), np.full((2, 2), 0.2), 0.0, 100.0)
    assert flight.lands == 81


# Layers over a row: what they have changes as they say, nothing else does, nothing slides and nothing jolts.


every_region = pytest.mark.parametrize("region", Region)
WIDTH = channel.SPINE + 12


def over(piece: MotionPiece, region: Region = Region.UPPER_BODY, **changes: object) -> PlayedLayer:
    usual = {"weight": 1.0, "fades": (0.0, 0.0), "additive": False, "reference": -1}
    return PlayedLayer((piece,), region, **{**usual, **changes})  # type: ignore[arg-type]


def part(name: str, first: int, last: int, start: float) -> MotionPiece:
    return cut(example(name), first=first, last=last, start=start)


def row_with(*overlays: PlayedLayer, row: str = "walk_turn") -> Composite:
    return with_layers((example(row),), overlays)


def test_regions_have_every_column_once_between_them() -> None:
    smallest = [each for each in Region if each.parts == {each}]
    counts = np.sum([columns_of(each, WIDTH) for each in smallest], axis=0)
    assert (counts == 1).all()
    assert columns_of(Region.WHOLE, WIDTH).all()
    assert np.array_equal(
        columns_of(Region.UPPER_BODY, WIDTH) | columns_of(Region.LEGS, WIDTH), columns_of(Region.WHOLE, WIDTH)
    )


@every_region
@pytest.mark.parametrize("additive", [False, True])
def test_a_layer_without_weight_changes_no_bit(region: Region, additive: bool) -> None:
    plain = compose_pieces((example("walk_turn"),))
    composite = row_with(over(part("straight_punch", 100, 260, 1.0), region, weight=0.0, additive=additive))
    assert composite.motion is plain.motion
    assert composite.contacts == plain.contacts


@every_region
def test_the_same_clip_over_itself_changes_nothing(region: Region) -> None:
    whole = example("walk_turn")
    plain, composite = compose_pieces((whole,)), row_with(over(cut(whole, first=60, last=300, start=1.0), region))
    np.testing.assert_allclose(composite.motion.channels, plain.motion.channels, atol=1e-9)
    assert sorted(composite.contacts, key=str) == sorted(plain.contacts, key=str)


@every_region
def test_a_clip_that_does_not_move_adds_nothing(region: Region) -> None:
    still = cut(example("straight_punch"), first=150, last=150)
    held = replace(still.motion, channels=np.tile(still.motion.channels[150], (100, 1)))
    composite = row_with(over(cut(still, motion=held, first=0, last=99, start=1.0), region, additive=True))
    np.testing.assert_allclose(composite.motion.channels, example("walk_turn").motion.channels, atol=1e-9)


@every_region
def test_only_its_region_changes_and_only_while_it_plays(region: Region) -> None:
    plain = example("walk_turn").motion.channels
    composite = row_with(over(part("straight_punch", 100, 260, 1.0), region, fades=(0.3, 0.3)))
    changed = composite.motion.channels != plain
    assert not changed[:, ~columns_of(region, plain.shape[1])].any()
    frames = np.flatnonzero(changed.any(axis=1))
    assert frames[0] > 60
    assert frames[-1] < 60 + 160
    middle = slice(60 + 30, 60 + 120)
    own = ResampledMotion(example("straight_punch").motion, example("walk_turn").motion.spine_places).at(
        np.arange(260.0)
    )
    of_region = columns_of(region, plain.shape[1])
    if region.parts <= Region.UPPER_BODY.parts:
        np.testing.assert_array_equal(composite.motion.channels[middle][:, of_region], own[130:220][:, of_region])


def test_what_is_added_twice_as_much_goes_twice_as_far() -> None:
    plain = example("walk_turn").motion.channels
    piece = part("straight_punch", 100, 260, 1.0)
    ways = []
    for weight in (0.25, 0.5):
        channels = row_with(over(piece, Region.WHOLE, weight=weight, additive=True, fades=(0.2, 0.2))).motion.channels
        ways.append(channels[:, channel.HIPS : channel.YAW + 1] - plain[:, channel.HIPS : channel.YAW + 1])
    np.testing.assert_allclose(ways[1], 2.0 * ways[0], atol=1e-9)
    assert np.abs(ways[0]).max() > 1e-3


def test_arms_of_one_clip_and_the_head_of_another_lie_over_each_other() -> None:
    punch, reach = part("straight_punch", 0, 300, 0.0), part("reach_grasp", 0, 300, 0.0)
    both = row_with(over(punch, Region.ARMS), over(reach, Region.HEAD)).motion.channels
    for overlay in (over(punch, Region.ARMS), over(reach, Region.HEAD)):
        columns = columns_of(overlay.region, both.shape[1])
        np.testing.assert_array_equal(both[:, columns], row_with(overlay).motion.channels[:, columns])


def test_a_layer_is_mirrored_repeated_and_faster_as_clips_are() -> None:
    piece = part("straight_punch", 150, 210, 1.0)
    twice = tuple(cut(piece, start=1.0 + 0.5 * index, speed=2.0, mirrored=True) for index in range(2))
    composite = row_with(replace(over(piece, Region.ARMS), pieces=twice, fades=(0.1, 0.1)))
    own = compose_pieces(twice, blends=True)
    arms = columns_of(Region.ARMS, composite.motion.channels.shape[1])
    np.testing.assert_allclose(
        composite.motion.channels[70:110][:, arms], own.motion.channels[10:50][:, arms], atol=1e-9
    )


@pytest.mark.parametrize("region", [Region.UPPER_BODY, Region.ARMS, Region.LEFT_ARM, Region.HEAD])
@pytest.mark.parametrize("additive", [False, True])
def test_contacts_of_feet_are_the_rows_where_it_has_the_legs(region: Region, additive: bool) -> None:
    composite = row_with(over(part("straight_punch", 0, 300, 1.0), region, additive=additive))
    assert composite.contacts == example("walk_turn").contacts


def test_contacts_of_feet_are_the_layers_where_that_has_the_legs() -> None:
    kick = example("front_kick")
    row = with_layers((example("straight_punch"),), (over(cut(kick, first=90, last=240, start=1.0), Region.LEGS),))
    for point in (each for each in ContactPoint if each.is_foot):
        for frame in range(125, 175):
            stands = [
                any(each.point is point and each.first <= when <= each.last for each in contacts)
                for contacts, when in ((row.contacts, frame), (kick.contacts, frame + 30))
            ]
            assert stands[0] == stands[1]


def test_hands_that_touch_let_go_where_one_of_them_plays_something_else() -> None:
    clap = ContactInterval("", Touch.HANDS_TOGETHER, 0, 399)
    held = cut(example("walk_turn"), contacts=(*example("walk_turn").contacts, clap))
    composite = with_layers((held,), (over(part("straight_punch", 0, 200, 1.0), Region.LEFT_ARM, fades=(0.2, 0.2)),))
    spans = [(each.first, each.last) for each in composite.contacts if each.point is Touch.HANDS_TOGETHER]
    assert len(spans) == 2
    assert spans[0][1] < 75
    assert spans[1][0] > 240


@pytest.mark.parametrize("region", [Region.UPPER_BODY, Region.RIGHT_ARM, Region.LEGS, Region.WHOLE])
@pytest.mark.parametrize("second", EXAMPLES[1:])
def test_no_foot_slides_and_no_joint_jolts_where_a_layer_comes_and_goes(region: Region, second: str) -> None:
    base = "straight_punch" if region in (Region.LEGS, Region.WHOLE) else "walk_turn"
    composite = row_with(over(part(second, 60, 270, 1.0), region), row=base)
    stands = standing(composite)
    quality = contact_quality(solve_constraints(stands, ()), composite.contacts, Ground())
    assert quality.slide < 1e-3
    assert quality.penetration < 1e-3
    usual = np.maximum(np.maximum(peaks(base), peaks(second)), QUIET_PEAK)
    assert (local_accelerations(stands).max(axis=0) / usual).max() < PERMITTED


def test_a_layer_that_is_none_is_refused() -> None:
    clip = Clip("motion", 0, 10)
    for wrong in ({"weight": 1.5}, {"weight": float("nan")}, {"fade_in": -0.1}, {"reference": -2}):
        with pytest.raises(ValueError, match="layer"):
            Layer(clip, **wrong)  # type: ignore[arg-type]


# Bodies side by side: across the direction in which their motion travels.


ROW = {f"body {k}": Performer(f"Body {k}", "character", position=(0.0, PERFORMER_SPACING * (1 - k))) for k in range(3)}


def walking(heading, metres=4.0, there_and_back=False):
    """A capture of which the root goes straight in a heading."""
    capture = make_capture(frames=60)
    way = np.linspace(0.0, 1.0, 60)
    way = np.minimum(way, 1.0 - way) * 2.0 if there_and_back else way
    moves = np.array(capture.poses.local_translations)
    moves[:, 0, :2] = metres * way[:, None] * [math.cos(heading), math.sin(heading)]
    return replace(capture, poses=PoseSequence(capture.poses.local_rotations, moves))


@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi / 2, -2.5])
@pytest.mark.parametrize("there_and_back", [False, True])
def test_a_walk_travels_where_its_root_goes(heading, there_and_back):
    assert travel_heading(walking(heading, there_and_back=there_and_back), 0, 59) == pytest.approx(heading, abs=0.05)


def test_who_stays_about_travels_nowhere():
    assert travel_heading(walking(1.0, metres=0.3), 0, 59) is None


@pytest.mark.parametrize("heading", [0.0, 0.7, math.pi / 2, -2.0])
def test_nobody_in_a_row_walks_into_another(heading):
    performers = performers_in_row(ROW, heading)
    places = np.array([each.position for each in performers.values()])
    way = np.array([math.cos(heading), math.sin(heading)])
    assert places @ way == pytest.approx(0.0, abs=1e-9)
    gaps = np.linalg.norm(places[:, None] - places, axis=-1)[np.triu_indices(3, 1)]
    assert gaps.min() == pytest.approx(PERFORMER_SPACING)
    assert places.mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_row_is_known_from_what_a_user_has_arranged():
    assert is_unarranged(ROW)
    assert is_unarranged(performers_in_row(ROW, 1.3))
    moved = ROW | {"body 1": replace(ROW["body 1"], position=(0.5, 0.0))}
    turned = ROW | {"body 1": replace(ROW["body 1"], heading=0.5)}
    assert not is_unarranged(moved)
    assert not is_unarranged(turned)


@pytest.mark.parametrize("missing", [["body 1"], ["body 0"], ["body 2"]])
def test_a_row_of_which_some_are_missing_is_still_one(missing):
    row = {key: each for key, each in performers_in_row(ROW, 0.4).items() if key not in missing}
    assert is_unarranged(row)


def swept_by(reach, way=0.0, travel=0.0):
    """Points of a body whose limbs reach so many metres to both sides, and which goes ``way`` metres across."""
    across, times = np.array([-math.sin(travel), math.cos(travel)]), np.linspace(0.0, 1.0, 30)
    sides = np.array([-reach, 0.0, reach]) * np.sin(math.pi * times)[:, None] + way * times[:, None]
    return sides[..., None] * across


@pytest.mark.parametrize("travel", [0.0, 1.1, -2.0])
@pytest.mark.parametrize(("reach", "ways"), [(0.4, (0.0, 3.0, -2.0)), (1.1, (0.0, 0.0, 0.0)), (0.8, (2.0, 2.0, 2.0))])
def test_those_who_spread_their_limbs_or_whose_paths_cross_stand_farther_apart(travel, reach, ways):
    """Only the roots were looked at: in a split neighbours cut into each other."""
    sweeps = {key: swept_by(reach, way, travel) for key, way in zip(ROW, ways, strict=True)}
    row = performers_in_row(ROW, travel, sweeps)
    across = np.array([-math.sin(travel), math.cos(travel)])
    tracks = [(np.array(each.position) + sweeps[key]) @ across for key, each in row.items()]
    tracks.sort(key=lambda track: -track[0].mean())
    for left, right in ((0, 1), (0, 2), (1, 2)):
        assert (tracks[left].min(axis=1) - tracks[right].max(axis=1)).min() > 0.29
    assert is_unarranged(row)


def test_those_who_keep_their_limbs_near_or_go_the_same_way_stand_as_near_as_usual():
    for way in (0.0, 5.0):
        row = performers_in_row(ROW, 0.3, {key: swept_by(0.4, way, 0.3) for key in ROW})
        assert math.dist(row["body 0"].position, row["body 1"].position) == pytest.approx(PERFORMER_SPACING)


@pytest.mark.parametrize("heading", [0.0, 1.3, math.pi / 2])
def test_one_more_performer_stands_beyond_the_end_of_the_row_and_far_enough_from_its_neighbour(heading):
    row = performers_in_row(ROW, heading)
    position = next_row_position(row, {"body 0": 9.0, "body 1": 9.0, "body 2": 1.5 * PERFORMER_SPACING})
    assert math.dist(position, row["body 2"].position) == pytest.approx(1.5 * PERFORMER_SPACING)
    assert is_unarranged(row | {"new": replace(ROW["body 0"], position=position)})


def test_one_more_performer_on_an_arranged_stage_stands_on_the_right_of_all():
    moved = ROW | {"body 1": replace(ROW["body 1"], position=(0.5, -3.0))}
    assert next_row_position(moved, dict.fromkeys(moved, 1.0)) == pytest.approx((0.5, -3.0 - PERFORMER_SPACING))
    assert next_row_position({}, {}) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("first", "second", "begins"), [("walk_turn", "handstand", 1.6), ("handstand", "walk_turn", 2.0)]
)
def test_no_contact_of_the_clip_that_ends_flashes_in_the_middle_of_an_overlap(first, second, begins) -> None:
    """A foot that had just been released was at another place for one frame, and moved there at 13 m/s."""
    composite = compose_pieces((example(first), cut(example(second), start=begins)))
    assert not composite.motion.changes  # hands support the body: channels are blended
    assert [each for each in composite.contacts if each.first == each.last] == []
