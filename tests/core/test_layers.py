"""Layers over a row: what they have changes as they say, nothing else does, nothing slides and nothing jolts."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.grounds.ground import Ground
from studio.core.kernels import layout as at
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.layers import PlayedLayer, columns_of, with_layers
from studio.core.normalized.pieces import MotionPiece
from studio.core.normalized.resample import ResampledMotion
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import contact_quality
from studio.core.solver.adapt import solve_constraints
from studio.core.stage.clip import Clip
from studio.core.stage.layer import Layer, Region
from tests.core.test_compose import EXAMPLES, PERMITTED, cut, example, local_accelerations, peaks, standing

every_region = pytest.mark.parametrize("region", Region)
WIDTH = at.SPINE + 12


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
        ways.append(channels[:, at.HIPS : at.YAW + 1] - plain[:, at.HIPS : at.YAW + 1])
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
    twice = tuple(cut(piece, start=1.0 + 0.5 * place, speed=2.0, mirrored=True) for place in range(2))
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
