"""Props where they are, in hands of any size, and mirrored."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.follow import FollowBody, FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.normalized.mirror import mirrored_contacts, mirrored_motion
from studio.core.normalized.motion import Girdle
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.rotations import from_euler, to_matrix
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.performers.prop_tracks import Holder, chest_headings, hand_over_seconds, stage_track
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.performers.staged_performances import StagedPerformances, adapt_performers
from studio.core.stage.holding import grip_constraints
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, InHand, Prop, PropShape
from studio.document.mirrored import mirrored_edit, mirrored_project
from studio.jobs.performances import prepared_capture
from studio.library.scenes import carrying
from tests.builders import make_character, make_constraint, make_morphology, make_project
from tests.core.motions import swaying

# Props where they are: fixed, keyed, in a hand, carried; and hands that hold them at any size.


LEFT, RIGHT = (BodyPoint(BodyPart(f"{side}_hand"), (0.0, 0.0, 0.08)) for side in ("left", "right"))
"""Middles of the palms."""


@pytest.fixture(scope="module")
def carry() -> Project:
    project = carrying.three_boxes()
    frames = [(key, replace(each, clips=(replace(each.clips[0], last=240),)), None) for key, each in _players(project)]
    return project.with_entities("performers", frames)


def _players(project: Project) -> list:
    return list(project.performers.items())


def performed(project: Project) -> StagedPerformances:
    made = adapt_performers(project, project.performers, prepared_capture, adapt)
    assert not made.failures
    return made


def on_side(prop: Prop, side: float, *, lower: float = 0.0) -> np.ndarray:
    """Middle of the left side (1) or the right one (-1) of a prop, in its axes."""
    return np.array([0.0, side * prop.size[1] / 2, -lower])


def sides_missed(project: Project, made: StagedPerformances) -> float:
    """Metres by which a palm is beside its side of the box, at most."""
    worst = 0.0
    for key, each in made.performances.items():
        placement = Placement.of(project.performers[key])
        frames = each.adapted_on_stage.frame_count
        holder = Holder(each.adapted_on_stage, np.arange(frames), placement)
        prop = project.props[f"box {key}"]
        track = stage_track(prop, np.arange(frames) / 60.0, {key: holder})
        for point, side in ((LEFT, 1.0), (RIGHT, -1.0)):
            wrist = placement.to_stage(body_point_positions(point, each.adapted_on_stage))
            asked = track.positions + track.rotations @ (on_side(prop, side))
            worst = max(worst, float(np.linalg.norm(wrist - asked, axis=1)[20:-20].max()))
    return worst


def test_palms_lie_on_the_sides_of_their_boxes_on_every_body(carry: Project) -> None:
    assert len({prop.size for prop in carry.props.values()}) == 3
    assert sides_missed(carry, performed(carry)) < 1e-3


@pytest.mark.parametrize("factor", [0.6, 1.25])
def test_boxes_of_any_size_are_held_by_bodies_of_any_build(carry: Project, factor: float) -> None:
    sizes = [prop.size for prop in carry.props.values()][::-1]
    props = [
        (key, replace(prop, size=tuple(factor * np.array(size))), None)
        for (key, prop), size in zip(carry.props.items(), sizes, strict=True)
    ]
    changed = carry.with_entities("props", props)
    assert sides_missed(changed, performed(changed)) < 1e-3


def test_a_box_stays_ahead_of_who_carries_it_and_does_not_sway_with_the_arms(carry: Project) -> None:
    for key, each in performed(carry).performances.items():
        frames = each.adapted_on_stage.frame_count
        holder = Holder(each.adapted_on_stage, np.arange(frames), Placement.of(carry.performers[key]))
        track = stage_track(carry.props[f"box {key}"], [0.0], {key: holder})
        root = holder.placement.to_stage(each.adapted_on_stage.positions[:, 0])
        away = (
            np.einsum("fi,fi->f", track.positions - root, track.rotations[:, :, 0])
            / each.adapted_on_stage.body.leg_length
        )
        assert away.min() > 0.25
        assert away.max() < 0.7


def test_a_prop_without_keys_stays_and_one_with_keys_passes_them() -> None:
    still = stage_track(Prop("Box", position=(1.0, 2.0, 3.0), heading=0.5), [0.0, 1.0])
    assert still.positions.tolist() == [[1.0, 2.0, 3.0]]
    keyed = Prop("Ball", position=KeyedPlace((0.0, 2.0), ((0, 0, 0), (2, 0, 1))), heading=KeyedNumber((1.0,), (0.3,)))
    track = stage_track(keyed, [0.0, 1.0, 2.0, 9.0])
    np.testing.assert_allclose(track.positions, [[0, 0, 0], [1, 0, 0.5], [2, 0, 1], [2, 0, 1]], atol=1e-12)
    assert np.arctan2(track.rotations[:, 1, 0], track.rotations[:, 0, 0]) == pytest.approx(0.3)


def test_a_stick_in_a_hand_goes_where_the_hand_is_brought() -> None:
    project = make_project(characters=2, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND, (0.02, 0.0, 0.01))
    stick = Prop("Stick", (0.03, 0.03, 1.0), shape=PropShape.STICK, held=InHand("performer 0", hand))
    project = project.with_entity("props", "stick", stick)
    asked = make_constraint(point=LEFT, target=FollowProp("stick", share=(0.0, 0.0, 1.0)))
    project = project.with_entity("constraints", "tip", asked)
    own, other = (constraints_of_performer(project, key)[0].constraint for key in project.performers)
    assert isinstance(own.target, FollowBody)
    assert own.target.point.offset == pytest.approx((0.02, 0.0, 0.51))
    assert isinstance(other.target, FollowProp)
    made = performed(project)
    adapted = made.performances["performer 0"].adapted
    tip = body_point_positions(own.target.point, adapted)
    turns = adapted.rotations[:, adapted.morphology.layout.segment_of_part(BodyPart.RIGHT_HAND)]
    np.testing.assert_allclose(tip - body_point_positions(hand, adapted), 0.5 * turns[:, :, 2], atol=1e-9)
    track = made.performances["performer 1"].request.tracks[other.target]
    seen = Placement.of(project.performers["performer 1"]).to_stage(track.positions)
    np.testing.assert_allclose(seen, Placement.of(project.performers["performer 0"]).to_stage(tip), atol=1e-9)


def test_a_hand_is_not_asked_to_follow_what_it_holds() -> None:
    project = make_project(characters=1, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    project = project.with_entity("props", "stick", Prop("Stick", held=InHand("performer 0", hand)))
    project = project.with_entity("constraints", "c", make_constraint(point=RIGHT, target=FollowProp("stick")))
    assert constraints_of_performer(project, "performer 0") == ()


def test_two_who_follow_what_the_other_one_holds_follow_where_it_is_in_the_end() -> None:
    project = make_project(characters=2, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    for name, holder in (("one", "performer 0"), ("other", "performer 1")):
        project = project.with_entity("props", name, Prop(name, held=InHand(holder, hand)))
        asked = make_constraint(point=LEFT, target=FollowProp(name))
        project = project.with_entity("constraints", name, asked)
    made = performed(project).performances
    for name, holder, follower in (("one", "performer 0", "performer 1"), ("other", "performer 1", "performer 0")):
        there = Placement.of(project.performers[holder]).to_stage(body_point_positions(hand, made[holder].adapted))
        followed = made[follower].request.tracks[FollowProp(name)].positions
        seen = Placement.of(project.performers[follower]).to_stage(followed)
        assert np.linalg.norm(seen - there, axis=1).max() < 1e-3


def test_a_prop_that_is_turned_in_a_hand_turns_what_follows_it() -> None:
    turn = (0.0, 0.0, np.sin(0.4), np.cos(0.4))
    project = make_project(characters=1, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    project = project.with_entity(
        "props", "stick", Prop("Stick", (1.0, 1.0, 1.0), held=InHand("performer 0", hand, turn))
    )
    asked = make_constraint(point=LEFT, target=FollowProp("stick", share=(1.0, 0.0, 0.0)))
    project = project.with_entity("constraints", "tip", asked)
    [found] = constraints_of_performer(project, "performer 0")
    assert found.constraint.target.point.offset == pytest.approx((0.5 * to_matrix(np.array(turn))[:, 0]).tolist())


PICKED, PUT = 2.5, 5.5
"""Seconds in which the walk carries something."""


def handled(manner: str, *, put: bool) -> tuple[Project, str]:
    """Three bodies of which one picks a box up and puts it down, with the wrists on it meanwhile."""
    project = carrying.three_boxes()
    key = list(project.performers)[1]
    from_here, to_there = (1.6, 0.0, 0.9), (4.0, 0.5, 0.7)
    position = KeyedPlace((PICKED, PUT), (from_here, to_there)) if put else from_here
    held = (
        replace(carrying_of(project, key), begin=PICKED, end=PUT)
        if manner == "both hands"
        else InHand(key, BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.0, 0.1)), begin=PICKED, end=PUT)
    )
    box = replace(project.props[f"box {key}"], position=position, held=held)
    project = project.with_entity("props", f"box {key}", box)
    if manner == "one hand":
        project = replace(project, constraints={})
    return project, key


def carrying_of(project: Project, key: str) -> Carried:
    held = project.props[f"box {key}"].held
    assert isinstance(held, Carried)
    return held


@pytest.mark.parametrize("put", [False, True], ids=["left", "put"])
@pytest.mark.parametrize("manner", ["both hands", "one hand"])
def test_a_prop_lies_until_it_is_picked_up_goes_with_the_hands_and_lies_where_it_is_put(manner: str, put: bool) -> None:
    project, key = handled(manner, put=put)
    made = performed(project).performances[key]
    timing = made.composite.timing
    times = np.arange(0.0, 8.0, 1.0 / 60.0)
    placement = Placement.of(project.performers[key])
    holder = Holder(made.adapted, timing.frames_at(times), placement, timing=timing)
    prop = project.props[f"box {key}"]
    track = stage_track(prop, times, {key: holder})
    own = stage_track(replace(prop, held=None), [0.0, 8.0])
    assert track.positions[times < PICKED] == pytest.approx(np.tile(own.positions[0], (np.sum(times < PICKED), 1)))
    after = track.positions[times > PUT]
    assert np.ptp(after, axis=0) == pytest.approx(0.0, abs=1e-9)
    if put:
        assert after[0] == pytest.approx(own.positions[-1])
    alone = stage_track(replace(prop, held=replace(prop.held, begin=None, end=None)), times, {key: holder}).positions
    far = np.linalg.norm(own.positions[0] - alone[np.searchsorted(times, PICKED)])
    near = np.linalg.norm(own.positions[-1] - alone[np.searchsorted(times, PUT)])
    middle = (times > PICKED + hand_over_seconds(far)) & (times < PUT - hand_over_seconds(near))
    middle |= np.abs(times - (PICKED + PUT) / 2) < 1e-6  # at the latest
    assert track.positions[middle] == pytest.approx(alone[middle], abs=1e-9)
    steps = np.linalg.norm(np.diff(track.positions, axis=0), axis=1)
    assert steps[np.searchsorted(times, PICKED)] * 60.0 < 0.05  # it does not start with a jerk


def test_a_box_on_the_floor_is_lifted_and_does_not_skate_with_who_walks_past() -> None:
    project, key = handled("both hands", put=False)
    prop = replace(project.props[f"box {key}"], position=(2.2, 0.0, 0.12))
    made = performed(project).performances[key]
    timing, times = made.composite.timing, np.arange(PICKED, PUT, 1.0 / 60.0)
    holder = Holder(made.adapted, timing.frames_at(times), Placement.of(project.performers[key]), timing=timing)
    places = stage_track(prop, times, {key: holder}).positions
    low = places[:, 2] < 0.12 + 0.05
    assert low[:5].all()
    assert np.linalg.norm(places[low, :2] - places[0, :2], axis=1).max() < 0.05


def test_palms_are_on_a_box_from_before_it_is_picked_up_until_it_is_put_down_on_any_body() -> None:
    for factor in (0.8, 1.0, 1.2):
        project, key = handled("both hands", put=False)
        character = project.characters[project.performers[key].character_id]
        grown = replace(character, proportions=Proportions(stature=factor))
        project = project.with_entity("characters", project.performers[key].character_id, grown)
        made = performed(project).performances[key]
        timing, placement = made.composite.timing, Placement.of(project.performers[key])
        times = np.arange(PICKED + 0.35, PUT - 0.05, 1.0 / 60.0)
        frames = np.rint(timing.frames_at(times)).astype(int)
        prop = project.props[f"box {key}"]
        track = stage_track(prop, times, {key: Holder(made.adapted, frames, placement, timing=timing)})
        for side, wrist in ((1.0, LEFT), (-1.0, RIGHT)):
            sides = track.positions + track.rotations @ on_side(prop, side)
            wrists = placement.to_stage(body_point_positions(wrist, made.adapted)[frames])
            missed = np.linalg.norm(wrists - sides, axis=1)
            assert missed.max() < 1e-2  # it walks past a box that lies 1 m off as it takes it
            assert missed[times > PICKED + 1.5].max() < 2e-3


def test_a_stick_is_held_by_one_hand_above_the_other_with_both_palms_on_it() -> None:
    """Hands on both of its sides were in each other's way: wrists missed by 30 mm, palms by 45 degrees."""
    project = carrying.three_boxes()
    key = next(iter(project.performers))
    stick = replace(project.props[f"box {key}"], name="Stick", size=(0.03, 0.03, 1.2), shape=PropShape.STICK)
    motion = project.performers[key].clips[0].motion_id
    asked = grip_constraints(motion, key, "stick", stick, (0.0, 20.0), 0)
    project = replace(project, constraints={}, props={"stick": stick})
    project = project.with_entities("constraints", [(f"grip {index}", each, None) for index, each in enumerate(asked)])
    made = performed(project).performances[key]
    holder = Holder(made.adapted, np.arange(made.adapted.frame_count), Placement.of(project.performers[key]))
    track = stage_track(stick, np.arange(made.adapted.frame_count) / 60.0, {key: holder})
    for side, wrist in ((1.0, LEFT), (-1.0, RIGHT)):
        held = track.positions + track.rotations @ np.array([0.0, side * 0.03, side * 0.12])
        wrists = Placement.of(project.performers[key]).to_stage(body_point_positions(wrist, made.adapted))
        assert np.linalg.norm(wrists - held, axis=1).max() < 2e-3
    assert np.nanmax(made.adapted.residuals) < np.radians(10.0)


@pytest.mark.parametrize(("ahead", "up"), [(0.35, 1.25), (0.15, 1.3), (0.42, 0.36), (0.6, -0.8)])
def test_palms_lie_on_a_box_overhead_and_on_the_floor_with_fingers_raised_along_the_arms(
    carry: Project, ahead: float, up: float
) -> None:
    """Fingers ahead were 81 degrees short on a box at (0.35, 0, 1.25) leg lengths, and 116 at (0.15, 0, 1.3);
    those that were raised for one height 92 degrees at another.
    """
    props = [
        (key, replace(box, held=replace(box.held, offset=(ahead, 0.0, up))), None) for key, box in carry.props.items()
    ]
    project = replace(carry.with_entities("props", props), constraints={})
    for key, _ in _players(project):
        asked = grip_constraints("walk", key, f"box {key}", project.props[f"box {key}"], (0.0, 20.0), 0)
        rows = [(f"grip {key} {index}", each, None) for index, each in enumerate(asked)]
        project = project.with_entities("constraints", rows)
    for each in performed(project).performances.values():
        rows = zip(each.adapted.residuals, each.request.constraints, strict=True)
        angles = [row for row, one in rows if one.unit == "rad"]
        assert len(angles) == 2
        assert np.nanmax(angles) < np.radians(10.0)


def test_hands_of_who_faces_a_prop_another_way_are_on_its_sides_as_they_face() -> None:
    wide, deep = Prop("Box", (0.4, 0.6, 0.3)), Prop("Box", (0.6, 0.4, 0.3))
    for turned, (left_x, left_y) in enumerate(((0, 1), (1, 0), (0, -1), (-1, 0))):
        prop = wide if turned % 2 == 0 else deep
        left, palm, right, _ = grip_constraints("m", "p", "box", prop, (0.0, 1.0), 0, turned=turned, lower=True)
        assert left.target.share == pytest.approx((left_x, left_y, -0.2 / 0.3))
        assert right.target.share == pytest.approx((-left_x, -left_y, -0.2 / 0.3))
        assert left.target.offset == (0.0, 0.0, -0.08)
        fingers, thumb = (to_matrix(np.array(palm.target.turn))[:, axis] for axis in (2, 1))
        assert fingers == pytest.approx((left_y, -left_x, 0.0))
        assert thumb == pytest.approx((0.0, 0.0, -1.0))


def test_a_carried_prop_keeps_its_heading_from_the_chest() -> None:
    project = carrying.three_boxes()
    key = next(iter(project.performers))
    made = performed(project).performances[key]
    holder = Holder(made.adapted, np.arange(made.adapted.frame_count), Placement.of(project.performers[key]))
    held = carrying_of(project, key)
    box, seconds = project.props[f"box {key}"], np.arange(made.adapted.frame_count) / 60.0
    turned = replace(box, held=replace(held, heading=np.pi))
    plain, other = (stage_track(each, seconds, {key: holder}) for each in (box, turned))
    np.testing.assert_allclose(other.positions, plain.positions, atol=1e-12)
    np.testing.assert_allclose(other.rotations[:, :2, :2], -plain.rotations[:, :2, :2], atol=1e-12)


GIVEN = 3.0
"""Seconds at which one hands a box to the other."""


def handing() -> Project:
    """Two walk beside each other: one carries a box until the other takes it, all wrists on it meanwhile."""
    project = carrying.three_boxes()
    one, other = list(project.performers)[:2]
    box = replace(project.props[f"box {one}"], held=Carried(one, carrying.HANDS_CENTRE, end=GIVEN))
    box = box.taken(Carried(other, carrying.HANDS_CENTRE), GIVEN)
    x, y = project.performers[one].position
    beside = replace(project.performers[other], position=(x, y + 0.5))
    project = replace(project, constraints={}, props={"box": box}).with_entity("performers", other, beside)
    motion = project.performers[one].clips[0].motion_id
    asked = [
        *grip_constraints(motion, one, "box", box, (0.0, GIVEN), 0),
        *grip_constraints(motion, other, "box", box, (GIVEN, 8.0), 0),
    ]
    return project.with_entities("constraints", [(f"grip {index}", each, None) for index, each in enumerate(asked)])


@pytest.mark.parametrize("pitch", [0.0, 60.0, 89.0, 91.0, 150.0])
def test_a_box_keeps_its_heading_while_who_carries_it_bends_down_beyond_level(pitch: float) -> None:
    """It was reversed, and the palms with it, as the chest's axis ahead pointed back."""
    bent = to_matrix(from_euler("ZY", np.array([0.3, math.radians(pitch)])))
    assert chest_headings(bent[None]) == pytest.approx([0.3])


def test_who_hands_a_box_to_another_holds_it_until_then_and_the_other_from_then_on() -> None:
    project = handing()
    one, other = list(project.performers)[:2]
    made = performed(project).performances
    times = np.arange(1.0, 5.5, 1.0 / 60.0)
    holders = {
        key: Holder(
            made[key].adapted,
            made[key].composite.timing.frames_at(times),
            Placement.of(project.performers[key]),
            timing=made[key].composite.timing,
        )
        for key in (one, other)
    }
    prop = project.props["box"]
    track = stage_track(prop, times, holders)
    alone = [
        stage_track(replace(prop, held=Carried(key, carrying.HANDS_CENTRE), later=()), times, holders)
        for key in holders
    ]
    assert track.positions[times < GIVEN] == pytest.approx(alone[0].positions[times < GIVEN], abs=1e-9)
    apart = np.linalg.norm(alone[1].positions - alone[0].positions, axis=1)
    far = apart[np.searchsorted(times, GIVEN)]
    after = times > GIVEN + hand_over_seconds(far)
    assert track.positions[after] == pytest.approx(alone[1].positions[after], abs=1e-9)
    steps = np.linalg.norm(np.diff(track.positions, axis=0), axis=1)
    usual = max(np.linalg.norm(np.diff(each.positions, axis=0), axis=1).max() for each in alone)
    assert far > 0.2
    assert steps.max() < usual + 1.875 * apart.max() / hand_over_seconds(far) / 60.0  # the steepest of an ease
    for key, holds in ((one, times < GIVEN), (other, times > GIVEN)):
        placement = Placement.of(project.performers[key])
        rows = np.rint(np.asarray(holders[key].rows)).astype(int)
        for side, wrist in ((1.0, LEFT), (-1.0, RIGHT)):
            sides = track.positions + track.rotations @ on_side(prop, side)
            wrists = placement.to_stage(body_point_positions(wrist, made[key].adapted)[rows])
            assert np.linalg.norm(wrists - sides, axis=1)[holds].max() < 2e-3


def test_hands_on_a_box_that_is_handed_over_report_the_residual_that_they_have() -> None:
    """Measured again on the final path of the box, the hands were said to be 80 mm off: a wrist to a palm."""
    for each in performed(handing()).performances.values():
        rows = zip(each.adapted.residuals, each.request.constraints, strict=True)
        worst = max((np.nanmax(row) for row, one in rows if one.unit == "m"), default=0.0)
        assert worst < 0.02


def looped(project: Project) -> Project:
    """Project whose first performer plays four seconds twice."""
    key, performer = next(iter(project.performers.items()))
    clip = replace(performer.clips[0], last=240, repeats=2)
    return project.with_entity("performers", key, replace(performer, clips=(clip,)))


def test_who_has_handed_a_box_over_does_not_reach_for_it_as_the_clip_plays_again() -> None:
    """The giver's hands were on their way to a box that the other had carried off: 347 mm short."""
    project = looped(handing())
    made = performed(project).performances[next(iter(project.performers))]
    assert {each.repeat for each in made.clip_constraints} == {0}
    times = made.composite.timing.begin + np.arange(made.adapted.frame_count) / 60.0
    assert np.isnan(made.adapted.residuals[:, times > GIVEN + 0.6]).all()
    assert np.isfinite(made.adapted.residuals[:, (times > 0.3) & (times < GIVEN)]).all()


def carrying_on() -> Project:
    """One body takes a box at 1.5 s and puts it down at 6 s, while a clip of 4 s plays twice."""
    hold = Carried("", carrying.HANDS_CENTRE, begin=1.5, end=6.0)
    asked = grip_constraints("walk", "", "box", Prop("Box", SIZE), (1.5, 4.0), 0)
    return own_of(carrier(hold, asked=asked, clip={"last": 240, "repeats": 2}))


@pytest.mark.parametrize("clips", [1, 2])
def test_hands_stay_on_a_box_while_it_is_held_as_its_clip_plays_again(clips: int) -> None:
    """They let go of it at every end of the clip, and took it again only where they had the first time."""
    project = carrying_on()
    if clips == 2:
        [(key, performer)] = project.performers.items()
        clip = replace(performer.clips[0], repeats=1)
        after = replace(clip, id="after", start=clip.length(60.0))
        project = project.with_entity("performers", key, replace(performer, clips=(clip, after)))
    [made] = performed(project).performances.values()
    seconds = made.composite.timing.begin + np.arange(made.adapted.frame_count) / 60.0
    held = (seconds > 1.5) & (seconds < 6.0)
    asked = np.max([each.activation.at(seconds) for each in made.request.constraints], axis=0)
    assert asked[seconds < 0.9].max() == 0.0
    assert asked[held] == pytest.approx(1.0)
    assert asked[seconds > 6.6].max() == 0.0
    rows = zip(made.adapted.residuals, made.request.constraints, strict=True)
    assert max(np.fmax.reduce(row[held]) for row, each in rows if each.unit == "m") < 2e-3


def test_hands_that_let_go_of_a_box_early_are_not_brought_back_to_it() -> None:
    project = carrying_on()
    early = [
        (name, replace(each, activation=each.activation.with_times(1.0, 1.5, 2.5, 3.0)), None)
        for name, each in project.constraints.items()
    ]
    [made] = performed(project.with_entities("constraints", early)).performances.values()
    first = [each.constraint.activation.times for each in made.clip_constraints if each.repeat == 0]
    assert first == [(1.0, 1.5, 2.5, 3.0)] * 4


def test_who_takes_a_prop_takes_it_out_of_the_hands_that_hold_it_then() -> None:
    box = Prop("Box", held=Carried("a")).taken(Carried("b"), 2.0).taken(Carried("c"), 3.0)
    assert [(each.performer_id, each.begin, each.end) for each in box.holds] == [
        ("a", None, 2.0),
        ("b", 2.0, 3.0),
        ("c", 3.0, None),
    ]
    assert [each.performer_id for each in box.taken(Carried("d"), 2.5).holds] == ["a", "b", "d"]
    assert box.holders == {"a", "b", "c"}
    assert [each.performer_id for each in box.without("b").holds] == ["a", "c"]
    moved = box.with_span(box.holds[1], 2.5, 2.8).holds
    assert [(each.begin, each.end) for each in moved] == [(None, 2.5), (2.5, 2.8), (2.8, None)]
    with pytest.raises(ValueError, match="must put the prop down before"):
        Prop("Box", held=Carried("a"), later=(Carried("b", begin=1.0),))


# Props held in mirrored clips: the hands lie on them as those of the unmirrored clip do, reflected.


LAST = 240
SIZE = (0.22, 0.34, 0.24)
HAND = BodyPoint(BodyPart.RIGHT_HAND, (0.02, 0.01, 0.03))


def carrier(*holds: Carried | InHand, asked: tuple[Constraint, ...], clip: dict | None = None) -> Project:
    """One body that walks with a box."""
    project = carrying.three_boxes()
    [key] = list(project.performers)[:1]
    performer = project.performers[key]
    walk = replace(performer.clips[0], **{"last": LAST, **(clip or {})})
    box = Prop("Box", SIZE).with_holds([replace(each, performer_id=key) for each in holds])
    alone = replace(performer, clips=(walk,), position=(0.0, 0.0), heading=0.0)
    constraints = {str(index): replace(each, motion_id=walk.motion_id) for index, each in enumerate(asked)}
    body = make_character()
    return replace(
        project,
        characters={performer.character_id: body},
        performers={key: alone},
        props={"box": box},
        constraints=constraints,
    )


def grips(turned: int, **how: float) -> tuple[Constraint, ...]:
    return grip_constraints("walk", "", "box", Prop("Box", SIZE), (0.0, 20.0), 0, turned=turned, **how)


def with_mirrored(project: Project) -> Project:
    players = [
        (key, replace(each, clips=tuple(replace(clip, mirrored=not clip.mirrored) for clip in each.clips)), None)
        for key, each in project.performers.items()
    ]
    return project.with_entities("performers", players)


def own_of(project: Project) -> Project:
    """Project whose grips belong to its only performer."""
    [key] = project.performers
    asked = [
        (name, replace(each, scope=replace(each.scope, performer_id=key)), None)
        for name, each in project.constraints.items()
    ]
    return project.with_entities("constraints", asked)


def assert_reflected(project: Project, other: Project, tolerance: float = 1e-4) -> None:
    """Residuals and hands of both projects are equal, apart from the side.

    Grounded motions without any constraint, too, are reflected to hundredths of a millimetre only.
    """
    made = [adapt_performers(each, each.performers, prepared_capture, adapt) for each in (project, other)]
    assert [each.failures for each in made] == [{}, {}]
    for key, plain in made[0].performances.items():
        seen = made[1].performances[key]
        np.testing.assert_allclose(seen.adapted_on_stage.residuals, plain.adapted_on_stage.residuals, atol=tolerance)
        assert np.isfinite(plain.adapted_on_stage.residuals).any()
        layout = plain.adapted_on_stage.body.first_frame_body.layout
        for side in range(2):
            own = plain.adapted_on_stage.positions[:][:, layout.wrist_point(side)]
            other_side = seen.adapted_on_stage.positions[:][:, layout.wrist_point(1 - side)]
            np.testing.assert_allclose(other_side, own * [1.0, -1.0, 1.0], atol=max(tolerance, 1e-4))


@pytest.mark.parametrize("clip", [{"offset": (0.2, 0.0)}, {"repeats": 2, "last": 120}, {"speed": 1.4}])
@pytest.mark.parametrize("turned", range(4))
def test_hands_of_a_mirrored_clip_lie_on_the_box_between_them(turned: int, clip: dict) -> None:
    hold = Carried("", carrying.HANDS_CENTRE, heading=turned * math.pi / 2)
    project = own_of(carrier(hold, asked=grips(turned), clip=clip))
    assert_reflected(project, with_mirrored(project))


def test_a_box_grasped_anew_after_it_was_turned_is_reflected_by_the_hold_of_that_time() -> None:
    first = Carried("", carrying.HANDS_CENTRE, end=1.5)
    second = Carried("", carrying.HANDS_CENTRE, math.pi / 2, begin=1.8)
    asked = [
        *(replace(each, activation=ActivationCurve(0.0, 0.2, 1.2, 1.5)) for each in grips(0)),
        *(replace(each, activation=ActivationCurve(2.3, 2.6, 3.4, 3.8)) for each in grips(1)),
    ]
    project = own_of(carrier(first, second, asked=tuple(asked), clip={"offset": (0.2, 0.0)}))
    other = with_mirrored(project)
    wrists = [each.target.share for each in constraints(other) if isinstance(each, PositionConstraint)]
    assert wrists == [(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)]


def constraints(project: Project) -> list:
    """Constraints of the only performer in its mirrored clip, before the mirror exchanges the hands."""
    [key] = project.performers
    found = (each.constraint for each in constraints_of_performer(project, key))
    return sorted(found, key=lambda each: each.activation.full)


def test_a_box_in_one_hand_that_the_other_hand_supports_is_reflected_with_its_hold() -> None:
    hold = InHand("", HAND, (0.1, 0.2, 0.3, 0.9))
    left = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    follow = FollowProp("box", (0.02, 0.03, 0.04), share=(0.3, 1.0, -0.5))
    curve = ActivationCurve(0.0, 0.5, 20.0, 20.5)
    asked = make_constraint(point=left, activation=curve, target=follow)
    for held in (hold, replace(hold, end=60.0)):
        project = own_of(carrier(held, asked=(asked,), clip={"offset": (0.2, 0.0)}))
        assert_reflected(project, with_holds_mirrored(with_mirrored(project)), tolerance=1e-3)  # out of the arm's reach


def with_holds_mirrored(project: Project) -> Project:
    box = project.props["box"]
    return project.with_entity("props", "box", box.with_holds([each.mirrored() for each in box.holds]))


@pytest.mark.parametrize("turned", range(4))
def test_a_box_carried_aside_aslant_and_tilted_is_reflected_with_its_hold(turned: int) -> None:
    hold = Carried("", (0.4, 0.06, 0.3), heading=turned * math.pi / 2 + 0.2, tilt=(0.1, -0.05, 0.08, 0.98))
    project = own_of(carrier(hold, asked=grips(turned), clip={"offset": (0.2, 0.0)}))
    assert_reflected(project, with_holds_mirrored(with_mirrored(project)))
    twice = hold.mirrored().mirrored()
    assert twice.heading == pytest.approx(math.remainder(hold.heading, math.tau))
    assert (twice.offset, twice.tilt) == (hold.offset, hold.tilt)


def test_a_box_that_is_handed_over_in_mirrored_clips_is_reflected_with_both_bodies() -> None:
    project = carrier(asked=())
    [(one, giver)] = project.performers.items()
    taker = replace(giver, position=(1.0, 0.0))
    project = project.with_entity("performers", "other", taker)
    box = Prop("Box", SIZE, held=Carried(one, carrying.HANDS_CENTRE, end=1.5))
    box = box.taken(Carried("other", carrying.HANDS_CENTRE), 1.5)
    motion = giver.clips[0].motion_id
    asked = [
        *grip_constraints(motion, one, "box", box, (0.0, 1.5), 0),
        *grip_constraints(motion, "other", "box", box, (1.5, 8.0), 0, lower=True),
    ]
    project = replace(project, props={"box": box}, constraints={str(index): each for index, each in enumerate(asked)})
    clips = [
        (key, replace(each, clips=(replace(each.clips[0], offset=(0.2, 0.0)),)), None)
        for key, each in project.performers.items()
    ]
    project = project.with_entities("performers", clips)
    assert_reflected(project, with_mirrored(project), tolerance=1e-3)  # beside the hands of the one who takes it


def test_a_mirrored_clip_shows_the_side_of_a_held_box_that_it_plays_and_an_edit_there_is_kept() -> None:
    hold = Carried("", carrying.HANDS_CENTRE, heading=math.pi / 2)
    project = with_mirrored(own_of(carrier(hold, asked=grips(1))))
    [(key, performer)] = project.performers.items()
    [clip] = performer.clips
    shown = mirrored_project(project, key, clip)
    for name, stored in project.constraints.items():
        seen = shown.constraints[name]
        assert mirrored_edit(project, key, clip, stored, seen) == stored
    left = next(name for name, each in project.constraints.items() if each.name == "Left hand on box")
    assert shown.constraints[left].name == "Right hand on box"
    share = project.constraints[left].target.share  # type: ignore[attr-defined]
    assert shown.constraints[left].target.share == (-share[0], 0.0, 0.0)  # type: ignore[attr-defined]


# Left for right: what is mirrored moves as its reflection does.


REFLECTED = np.array([1.0, -1.0, 1.0])


def test_a_mirrored_motion_is_the_reflection_with_left_and_right_exchanged() -> None:
    motion, _ = normalize_capture(swaying(3, hinged=True))
    body = make_morphology(spine_count=4)
    layout = body.layout
    other_side = list(range(layout.point_count))
    for first in (layout.collar_point, layout.hip_point):
        left, right = (range(first(side), first(side) + 5) for side in range(2))
        for a, b in zip(left, right, strict=True):
            other_side[a], other_side[b] = b, a
    plain, _ = realize_motion(motion, body)
    seen, rotations = realize_motion(mirrored_motion(motion), body)
    np.testing.assert_allclose(seen[:, other_side] * REFLECTED, plain, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-12)


def test_hands_and_feet_turn_as_their_reflections_do() -> None:
    motion, _ = normalize_capture(swaying(5, hinged=True))
    body = make_morphology()
    spine = body.layout.spine_count
    (_, plain), (_, seen) = realize_motion(motion, body), realize_motion(mirrored_motion(motion), body)
    for left, right, axes in ((spine + 5, spine + 9, [-1.0, 1.0, 1.0]), (spine + 12, spine + 16, [1.0, -1.0, 1.0])):
        np.testing.assert_allclose(np.diag(REFLECTED) @ seen[:, right] @ np.diag(axes), plain[:, left], atol=1e-12)


def test_mirrored_twice_is_the_motion_itself() -> None:
    motion, _ = normalize_capture(swaying(1))
    np.testing.assert_array_equal(mirrored_motion(mirrored_motion(motion)).channels, motion.channels)


def test_the_shoulders_of_a_mirrored_motion_are_mirrored() -> None:
    motion, _ = normalize_capture(swaying(3, hinged=True))
    steep = replace(make_morphology(), clavicle_rest=np.array([[0.0, 0.8, 0.6], [0.0, -1.0, 0.0]]))
    asked = replace(motion, girdle=Girdle(0.8, np.array([[0.1, 0.9, -0.4], [0.0, -1.0, 0.0]]), 0.2, np.full(4, 0.5)))
    plain, _ = realize_motion(asked, steep)
    seen, _ = realize_motion(
        mirrored_motion(asked), replace(steep, clavicle_rest=steep.clavicle_rest[::-1] * REFLECTED)
    )
    left, right = (steep.layout.collar_point(side) + 1 for side in range(2))
    np.testing.assert_allclose(seen[:, right] * REFLECTED, plain[:, left], atol=1e-12)


def test_contacts_are_those_of_the_other_side() -> None:
    seat, heel = (ContactInterval("m", point, 2, 5) for point in (ContactPoint.SEAT, ContactPoint.LEFT_HEEL))
    assert mirrored_contacts((seat, heel)) == (seat, ContactInterval("m", ContactPoint.RIGHT_HEEL, 2, 5))
