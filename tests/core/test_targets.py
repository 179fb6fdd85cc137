"""Targets that are keyed or follow something: on every body they are what the same fixed targets would be."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.normalized.normalize import normalize_capture
from studio.core.quality.metrics import centre_of_mass, contact_quality
from studio.core.rotations import angle_between, from_matrix, to_matrix
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.grounding.support_polygon import (
    averaged_polygons,
    standing_mask,
    support_margins,
    support_polygons,
)
from studio.core.solver.performers.anticipated_targets import with_anticipated_targets
from studio.core.solver.performers.followed_tracks import captured_joint_track, performer_track
from studio.core.solver.performers.prop_tracks import stage_track, track_in_motion_space
from studio.core.solver.performers.stage import constraint_for_performer
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import Track
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop
from studio.io.project.character_file import bundled_characters
from tests.core.motions import RATE, swaying, walk
from tests.core.test_constraint_kinds import ALL, HEAD, LEFT, MET, RIGHT, ask

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(90)
every_body = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
TURN = (0.1, 0.2, 0.1, 0.9)


def solved(
    body: Morphology, *constraints: Constraint, tracks: Mapping[Any, Any] = {}, frames: Any = ()
) -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, body, CONTACTS, constraints, tracks=tracks), *frames)


def same(first: AdaptedMotion, second: AdaptedMotion) -> None:
    assert first.positions == pytest.approx(second.positions, abs=1e-7)
    assert first.rotations == pytest.approx(second.rotations, abs=1e-7)
    assert first.residuals == pytest.approx(second.residuals, abs=1e-7, nan_ok=True)


def within_reach(body: Morphology, *further: float) -> np.ndarray:
    near = body_point_positions(RIGHT, solved(body))[30] + [0.05, 0.02, 0.08]
    return np.add(near, further or 0.0)


@every_body
def test_where_a_body_has_its_own_place_nothing_moves_and_an_offset_goes_by_its_measure(body: Morphology) -> None:
    standing, time = solved(body), 30 / RATE
    same(
        solved(body, ask(PositionConstraint, RIGHT, target=OwnPlace(LEFT, time))),
        solved(body, ask(PositionConstraint, RIGHT, target=tuple(body_point_positions(LEFT, standing)[30]))),
    )
    at_rest = solved(body, ask(PositionConstraint, RIGHT, target=OwnPlace(RIGHT, time)))
    assert at_rest.residuals[0, 30] < MET
    assert at_rest.positions[30] == pytest.approx(standing.positions[30], abs=MET)
    offset = (0.02, 0.03, 0.05)
    target = tuple(body_point_positions(RIGHT, standing)[30] + body.leg_length * np.array(offset))
    asked = ask(PositionConstraint, RIGHT, target=OwnPlace(RIGHT, time, offset))
    same(solved(body, asked), solved(body, ask(PositionConstraint, RIGHT, target=target)))
    same(solved(body, asked, frames=(20, 40)), solved(body, asked).frames(20, 40))


@every_body
def test_keys_and_rules_per_character_count_from_each_body_s_own_place(body: Morphology) -> None:
    own, times = OwnPlace(RIGHT, 30 / RATE), (0.2, 0.7)
    there = body_point_positions(RIGHT, solved(body))[30]
    values = ((0.0, 0.0, 0.0), (0.02, 0.03, 0.05))
    keys = KeyedOwnPlace(times, values, origin=own)
    shared = KeyedPlace(times, tuple(map(tuple, (there + body.leg_length * np.array(values)).tolist())))
    same(
        solved(body, ask(PositionConstraint, RIGHT, target=keys)),
        solved(body, ask(PositionConstraint, RIGHT, target=shared)),
    )
    circle, (x, y, z) = CirclePlace(radius=0.05, centre=(0.0, 0.0, 0.1), origin=own), there.tolist()
    same(
        solved(body, ask(PositionConstraint, RIGHT, target=circle)),
        solved(body, ask(PositionConstraint, RIGHT, target=CirclePlace(radius=0.05, centre=(x, y, z + 0.1)))),
    )


def test_a_performer_s_own_offset_is_its_alone() -> None:
    place = OwnPlace(RIGHT, 0.5, (0.0, 0.0, 0.1), (("tall", (0.0, 0.2, 0.0)),))
    asked = ask(PositionConstraint, RIGHT, target=place)
    assert constraint_for_performer(asked, "tall", (), {}).target == OwnPlace(RIGHT, 0.5, (0.0, 0.2, 0.1))  # type: ignore[attr-defined]
    assert constraint_for_performer(asked, "child", (), {}).target == OwnPlace(RIGHT, 0.5, (0.0, 0.0, 0.1))  # type: ignore[attr-defined]
    keyed = ask(PositionConstraint, RIGHT, target=place.keyed(0.2))
    assert constraint_for_performer(keyed, "tall", (), {}).target.origin == OwnPlace(RIGHT, 0.5, (0.0, 0.2, 0.1))  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="two offsets"):
        OwnPlace(RIGHT, 0.5, own=(("tall", (0.0, 0.0, 0.0)), ("tall", (0.0, 0.0, 0.1))))


@every_body
def test_equal_keys_are_a_fixed_target(body: Morphology) -> None:
    place, times = tuple(within_reach(body)), (0.2, 0.7)
    pairs = [
        (PositionConstraint, RIGHT, ALL, {"target": place}, {"target": KeyedPlace(times, (place, place))}),
        (LookAtConstraint, EYES_POINT, HEAD, {"target": place}, {"target": KeyedPlace(times, (place, place))}),
        (
            OrientationConstraint,
            BodyPoint(BodyPart.RIGHT_HAND),
            HEAD,
            {"target": TURN},
            {"target": KeyedTurn(times, (TURN, TURN))},
        ),
        (
            DistanceConstraint,
            RIGHT,
            ALL,
            {"other": place, "distance": 0.1},
            {"other": KeyedPlace(times, (place, place)), "distance": KeyedNumber(times, (0.1, 0.1))},
        ),
        (
            AreaConstraint,
            RIGHT,
            ALL,
            {"centre": place, "size": (0.3, 0.4, 0.2), "shape": "box", "heading": 0.4},
            {
                "centre": KeyedPlace(times, (place, place)),
                "heading": KeyedNumber(times, (0.4, 0.4)),
                "size": (0.3, 0.4, 0.2),
                "shape": "box",
            },
        ),
        (
            BalanceConstraint,
            BodyPoint(BodyPart.PELVIS),
            ALL,
            {"place": (0.5, 0.1)},
            {"place": KeyedPlace(times, ((0.5, 0.1, 1.0),) * 2)},
        ),
    ]
    for kind, point, chain, fixed, keyed in pairs:
        same(
            solved(body, ask(kind, point, chain, **fixed), frames=(20, 50)),
            solved(body, ask(kind, point, chain, **keyed), frames=(20, 50)),
        )


@every_body
def test_a_keyed_target_is_met_at_its_keys_and_between(body: Morphology) -> None:
    frames = (20, 35, 60)
    path = body_point_positions(RIGHT, solved(body))
    keyed = KeyedPlace(tuple(f / RATE for f in frames), tuple(tuple(path[f] + [0.03, 0.0, 0.05]) for f in frames))
    adapted = solved(body, ask(PositionConstraint, RIGHT, ALL, target=keyed), frames=(20, 60))
    reached = body_point_positions(RIGHT, adapted)
    assert reached[[0, 15, 40]] == pytest.approx(np.array(keyed.values), abs=MET)
    assert np.nanmax(adapted.residuals) < MET
    assert contact_quality(adapted, CONTACTS, Ground()).slide < 1e-3


@every_body
def test_following_an_unmoved_prop_is_a_fixed_target(body: Morphology) -> None:
    own = Placement((1.0, -2.0), 0.7)
    place = within_reach(body)
    stage = own.to_stage(place)
    prop = Prop("Box", position=tuple(stage - [0.0, 0.0, 0.1]), heading=0.3)
    follow = FollowProp("box", (0.0, 0.0, 0.1))
    tracks = {follow: track_in_motion_space(follow, prop, stage_track(prop, [0.0]), own)}
    same(
        solved(body, ask(PositionConstraint, RIGHT, ALL, target=follow), tracks=tracks, frames=(25, 40)),
        solved(body, ask(PositionConstraint, RIGHT, ALL, target=tuple(place)), frames=(25, 40)),
    )
    area = {"size": (0.3, 0.2, 0.4), "shape": "box"}
    same(
        solved(body, ask(AreaConstraint, RIGHT, ALL, centre=follow, **area), tracks=tracks, frames=(25, 40)),
        solved(body, ask(AreaConstraint, RIGHT, ALL, centre=tuple(place), heading=-0.4, **area), frames=(25, 40)),
    )


@every_body
def test_a_hand_follows_where_the_other_hand_is_brought(body: Morphology) -> None:
    goal = tuple(within_reach(body, 0.1, 0.15, 0.05))
    leader = ask(PositionConstraint, RIGHT, ALL, target=goal)
    follower = ask(
        PositionConstraint, LEFT, ALL, 1, target=FollowBody(BodyPoint(BodyPart.RIGHT_HAND, (0.05, 0.0, 0.0)))
    )
    adapted = solved(body, leader, follower, frames=(25, 40))
    gap = body_point_positions(LEFT, adapted) - body_point_positions(
        BodyPoint(BodyPart.RIGHT_HAND, (0.05, 0.0, 0.0)), adapted
    )
    assert np.linalg.norm(gap, axis=1) == pytest.approx(adapted.residuals[1], abs=1e-9)
    assert adapted.residuals[0].max() < MET
    assert np.linalg.norm(gap, axis=1).max() < MET


@every_body
def test_the_eyes_follow_the_own_hand_and_a_palm_the_other_one(body: Morphology) -> None:
    goal = tuple(within_reach(body, 0.3, 0.1, 0.1))
    hand = ask(PositionConstraint, RIGHT, ALL, target=goal)
    look = ask(LookAtConstraint, EYES_POINT, HEAD, 1, target=FollowBody(RIGHT))
    hands = [body.layout.segment_of_part(part) for part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)]
    left, right = solved(body, hand).rotations[30, hands]
    turn = from_matrix(right.T @ left @ to_matrix(np.array(TURN) / np.linalg.norm(TURN)))
    follow = FollowBody(BodyPoint(BodyPart.RIGHT_HAND), tuple(turn))
    palm = ask(OrientationConstraint, BodyPoint(BodyPart.LEFT_HAND), Chain(1.0, 1.0, 1.0), 2, target=follow)
    request = AdaptRequest(WALK, body, CONTACTS, (hand, look, palm))
    adapted = adapt(request, 25, 40)
    line = body_point_positions(RIGHT, adapted) - body_point_positions(EYES_POINT, adapted)
    gaze = adapted.rotations[:, body.layout.head_joint, :, 0]
    cosine = np.sum(gaze * line, axis=1) / np.linalg.norm(line, axis=1)
    miss = np.arccos(np.clip(cosine, -1.0, 1.0))
    assert miss == pytest.approx(adapted.residuals[1], abs=np.radians(0.1))
    left, right = (adapted.rotations[:, segment] for segment in hands)
    wanted = right @ to_matrix(turn)
    missed = angle_between(from_matrix(left), from_matrix(wanted))
    assert missed == pytest.approx(adapted.residuals[2], abs=np.radians(0.1))
    assert missed[:11].max() < np.radians(0.1)  # near the frame whose turn it is; later a wrist may be at its limit


@every_body
def test_a_segment_follows_the_turn_and_a_point_the_place_of_another_part_of_the_trunk(body: Morphology) -> None:
    turn = (0.04, 0.08, 0.06, 1.0)
    trunk = Chain(0.0, 0.0, 0.0, 1.0)
    as_pelvis = ask(
        OrientationConstraint, BodyPoint(BodyPart.THORAX), trunk, target=FollowBody(BodyPoint(BodyPart.PELVIS), turn)
    )
    adapted = solved(body, as_pelvis, frames=(25, 40))
    pelvis, thorax = (
        adapted.rotations[:, body.layout.segment_of_part(part)] for part in (BodyPart.PELVIS, BodyPart.THORAX)
    )
    wanted = pelvis @ to_matrix(np.array(turn) / np.linalg.norm(turn))
    assert angle_between(from_matrix(thorax), from_matrix(wanted)) == pytest.approx(0.0, abs=np.radians(0.1))
    before, head = solved(body), BodyPoint(BodyPart.HEAD, at_end=True)
    chest = before.rotations[30, body.layout.segment_of_part(BodyPart.THORAX)]
    above = (
        chest.T @ (body_point_positions(head, before) - body_point_positions(BodyPoint(BodyPart.THORAX), before))[30]
    )
    forward = above + np.array([0.02, 0.0, 0.0])
    place = FollowBody(BodyPoint(BodyPart.THORAX, tuple(forward.tolist())))
    held = solved(body, ask(PositionConstraint, head, Chain(0.0, 0.0, 1.0, 1.0), target=place), frames=(29, 31))
    gap = body_point_positions(head, held) - body_point_positions(place.point, held)
    assert np.linalg.norm(gap, axis=1) == pytest.approx(held.residuals[0], abs=1e-9)
    assert held.residuals.max() < 2e-3


@every_body
def test_a_half_space_turns_with_what_it_follows(body: Morphology) -> None:
    wall, before = FollowTracked("wall"), body_point_positions(RIGHT, solved(body))[30]
    quarter = np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
    area = ask(AreaConstraint, RIGHT, ALL, centre=wall, shape=AreaShape.HALF_SPACE, size=(1.0, 0.0, 0.0))
    tracks = {wall: Track((before + np.array([0.3, 0.05, 0.1]))[None], quarter)}
    moved = body_point_positions(RIGHT, solved(body, area, tracks=tracks, frames=(30, 30)))[0] - before
    assert moved == pytest.approx([0.0, 0.05, 0.0], abs=MET)


@every_body
def test_a_half_space_tilts_with_the_prop_it_follows(body: Morphology) -> None:
    lid, before = FollowProp("lid"), body_point_positions(RIGHT, solved(body))[30]
    normal = np.array([np.sin(0.4), 0.0, np.cos(0.4)])
    tilted = Rotation.from_rotvec([0.0, 0.4, 0.0]).as_matrix()
    area = ask(AreaConstraint, RIGHT, ALL, centre=lid, shape=AreaShape.HALF_SPACE, size=(0.0, 0.0, 2.0))
    tracks = {lid: Track((before + 0.05 * normal)[None], tilted[None])}
    moved = body_point_positions(RIGHT, solved(body, area, tracks=tracks, frames=(30, 30)))[0] - before
    assert moved == pytest.approx(0.05 * normal, abs=MET)


def test_a_tracked_joint_is_where_the_capture_has_it_in_the_space_of_the_motion() -> None:
    capture = swaying(3)
    motion, actor = normalize_capture(capture)
    track = captured_joint_track(FollowTracked("LeftHand"), capture)
    own = adapt(AdaptRequest(motion, actor.morphology))
    assert track.positions.shape == (capture.frame_count, 3)
    source = solve_constraints(ground_motion(motion, actor.morphology, (), Ground()), ())
    wrist = source.positions[:, actor.morphology.layout.wrist_point(0)]
    assert track.positions == pytest.approx(wrist, abs=0.02)  # the body is set on the ground, the capture is not
    assert own.frame_count == len(track.rotations)
    with pytest.raises(StudioError, match="No joint is called 'Ball'"):
        captured_joint_track(FollowTracked("Ball"), capture)


@every_body
def test_another_performer_is_followed_as_the_stage_has_it(body: Morphology) -> None:
    other, leader, own = (
        solved(BODIES["giant"]),
        Placement((3.0, 1.0), 2.0),
        Placement((0.5, -1.0), 0.4),
    )
    rows = np.arange(WALK.frame_count) * 0.5
    follow = FollowPerformer("giant", LEFT)
    track = performer_track(follow.point, follow.turn, other, rows, leader, own)
    stage = leader.to_stage(body_point_positions(LEFT, other))
    assert own.to_stage(track.positions)[::2] == pytest.approx(stage[: len(rows[::2])], abs=1e-9)
    assert own.to_stage(track.positions)[1] == pytest.approx((stage[0] + stage[1]) / 2, abs=1e-9)
    adapted = solved(
        body, ask(LookAtConstraint, EYES_POINT, HEAD, target=follow), tracks={follow: track}, frames=(10, 20)
    )
    fixed = ask(LookAtConstraint, EYES_POINT, HEAD, target=tuple(track.positions[15]))
    assert adapted.rotations[5] == pytest.approx(solved(body, fixed, frames=(15, 15)).rotations[0], abs=1e-9)


def test_what_is_followed_and_not_there_is_told_by_the_constraint() -> None:
    with pytest.raises(StudioError, match="'PositionConstraint' follows something that no longer exists"):
        solved(BODIES["child"], ask(PositionConstraint, RIGHT, target=FollowProp("gone")))


@every_body
def test_one_frame_alone_is_as_in_the_whole_clip(body: Morphology) -> None:
    path = body_point_positions(RIGHT, solved(body))
    keyed = KeyedPlace((0.2, 0.6, 1.2), tuple(tuple(path[f] + [0.03, 0.0, 0.05]) for f in (12, 36, 72)))
    constraints = (
        ask(PositionConstraint, RIGHT, ALL, target=keyed),
        ask(LookAtConstraint, EYES_POINT, HEAD, 1, target=FollowBody(RIGHT)),
        ask(BalanceConstraint, BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), 2, place=Support()),
    )
    whole = solved(body, *constraints)
    for frame in (0, 33, 89):
        alone = solved(body, *constraints, frames=(frame, frame))
        assert alone.positions[0] == pytest.approx(whole.positions[frame], abs=1e-9)


@every_body
def test_the_height_of_the_mass_is_asked_only_where_it_is_to_be(body: Morphology) -> None:
    before = centre_of_mass(solved(body))
    lower = tuple(before[30] - [0.0, 0.0, 0.03])
    for vertical in (False, True):
        asked = ask(BalanceConstraint, BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), place=lower, vertical=vertical)
        adapted = solved(body, asked, frames=(30, 30))
        mass = centre_of_mass(adapted)[0]
        assert adapted.residuals[0, 0] < 1e-3
        assert np.linalg.norm((mass - lower)[: 3 if vertical else 2]) == pytest.approx(
            adapted.residuals[0, 0], abs=1e-6
        )
        assert (mass[2] < before[30, 2] - 0.02) == vertical


places = st.tuples(*[st.floats(-1.5, 1.5)] * 3)
turns = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(lambda vector: (*vector, 0.5))


@st.composite
def moving_targets(draw: st.DrawFn, of: Any, keyed: Any) -> Any:
    """Fixed, keyed, or following a point of the body."""
    match draw(st.sampled_from(["fixed", "keyed", "own"])):
        case "fixed":
            return draw(of)
        case "keyed":
            times = np.cumsum(draw(st.lists(st.floats(0.05, 0.6), min_size=1, max_size=4)))
            return keyed(tuple(times), tuple(draw(of) for _ in times))
    return FollowBody(
        BodyPoint(draw(st.sampled_from(list(BodyPart))), draw(places), at_end=draw(st.booleans())), draw(turns)
    )


@st.composite
def any_constraint(draw: st.DrawFn, priority: int) -> Constraint:
    """Of any kind, with any target, on any part."""
    point = BodyPoint(draw(st.sampled_from(list(BodyPart))), at_end=draw(st.booleans()))
    place = draw(moving_targets(places, KeyedPlace).filter(lambda target: getattr(target, "point", None) != point))
    if isinstance(place, FollowBody) and place.point.part == point.part:
        place = (0.3, 0.2, 1.0)
    turn = draw(moving_targets(turns, KeyedTurn))
    if isinstance(turn, FollowBody) and turn.point.part == point.part:
        turn = (0.0, 0.0, 0.0, 1.0)
    kind, more = draw(
        st.sampled_from(
            [
                (PositionConstraint, {"target": place}),
                (LookAtConstraint, {"target": place}),
                (OrientationConstraint, {"target": turn}),
                (DistanceConstraint, {"other": place, "distance": 0.2}),
                (BalanceConstraint, {"place": draw(st.sampled_from([place, Support(), None, (0.2, 0.1)]))}),
                (AreaConstraint, {"centre": place, "shape": "box", "size": (0.4, 0.3, 0.5), "inside": True}),
            ]
        )
    )
    return ask(kind, point, draw(st.sampled_from([ALL, HEAD, Chain()])), priority, **more)


@given(st.data())
def test_whatever_is_asked_nothing_is_ever_not_a_number(data: st.DataObject) -> None:
    asked = [data.draw(any_constraint(priority)) for priority in range(data.draw(st.integers(1, 4)))]
    body = BODIES[data.draw(st.sampled_from(list(BODIES)))]
    adapted = solved(body, *asked, frames=(20, 40))
    assert np.isfinite(adapted.positions).all()
    assert np.isfinite(adapted.rotations).all()
    alone = solved(body, *asked, frames=(30, 30))
    assert alone.positions[0] == pytest.approx(adapted.positions[10], abs=1e-9)


@every_body
def test_over_the_support_the_centre_of_mass_is_within_the_soles_that_stand(body: Morphology) -> None:
    margin = 0.01
    asked = ask(BalanceConstraint, BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), place=Support(margin))
    standing = ground_motion(WALK, body, CONTACTS, Ground())
    before, adapted = solve_constraints(standing, ()), solve_constraints(standing, (asked,))
    stands = standing_mask(CONTACTS, WALK.frame_count)
    areas, presence = averaged_polygons(support_polygons(before.positions, before.rotations, stands, body), RATE)
    held = (presence > 1.0 - 1e-9) & (adapted.residuals[0] < 1e-3)
    held[: round(0.1 * RATE)] = False  # the motion begins within a step, whose foot is landing
    margins = [support_margins(areas, centre_of_mass(each)[:, :2]) for each in (before, adapted)]
    assert held.sum() > 30
    assert margins[1][held].min() > -margin  # what smoothness takes of it, while feet roll
    assert margins[0].min() < margins[1].min()
    plain = support_polygons(before.positions, before.rotations, stands, body)
    assert np.nanmin(support_margins(plain, plain_centre(plain))) > 0.0


@every_body
def test_who_stands_on_hands_and_knees_is_supported_between_them(body: Morphology) -> None:
    standing = ground_motion(WALK, body, CONTACTS, Ground())
    points = [ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND, ContactPoint.LEFT_KNEE, ContactPoint.SEAT]
    contacts = [ContactInterval("walk", point, 10, 20) for point in points]
    areas = support_polygons(standing.positions, standing.rotations, standing_mask(contacts, WALK.frame_count), body)
    assert (
        np.isfinite(areas).all(axis=1) == ((np.arange(WALK.frame_count) >= 10) & (np.arange(WALK.frame_count) <= 20))
    ).all()
    layout = body.layout
    middle = standing.positions[
        10:21, [layout.wrist_point(0), layout.wrist_point(1), layout.hip_point(0) + 1, layout.hip_point(1)], :2
    ].mean(axis=1)
    assert support_margins(areas[10:21], middle).min() > 0.0


def plain_centre(areas: np.ndarray) -> np.ndarray:
    """(F, 2) the middle of outlines, from their support functions."""
    angles = np.arange(areas.shape[1]) * 2 * np.pi / areas.shape[1]
    return 2.0 / areas.shape[1] * areas @ np.stack([np.cos(angles), np.sin(angles)], axis=1)


def test_what_is_awaited_is_where_it_is_once_it_is_asked_wholly_and_what_is_chased_where_it_is() -> None:
    ways = np.linspace(0.0, 1.0, 90)[:, None] * [1.0, 2.0, 0.5]
    track = Track(ways, np.tile(np.eye(3), (90, 1, 1)))
    curve = ActivationCurve(20 / RATE, 30 / RATE, 40 / RATE, 55 / RATE)
    for awaits in (True, False):
        follow = FollowPerformer("other", HEAD, awaits=awaits)
        asked = PositionConstraint("motion", "Meet", BodyPoint(BodyPart.RIGHT_HAND), Chain(), 0, curve, target=follow)
        places = with_anticipated_targets({follow: track}, [asked], RATE)[follow].positions
        whole = [*range(20), *range(30, 41), *range(56, 90)]
        assert np.array_equal(places[whole], ways[whole])
        assert np.array_equal(places[20:30], np.tile(ways[30], (10, 1)) if awaits else ways[20:30])
        assert np.array_equal(places[41:56], np.tile(ways[40], (15, 1)) if awaits else ways[41:56])
