"""Props where they are: fixed, keyed, in a hand, carried; and hands that hold them at any size."""

from dataclasses import replace

import numpy as np
import pytest

from studio.cli.render import prepared
from studio.core.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowBody, FollowProp
from studio.core.constraints.keyed import KeyedNumber, KeyedPlace
from studio.core.placement import Placement
from studio.core.project import Project
from studio.core.prop import InHand, Prop, PropShape
from studio.core.rotations import to_matrix
from studio.core.solver.adapt import adapt, place_of
from studio.core.solver.performing import Staged, perform
from studio.core.solver.props import Holder, stage_track
from studio.core.solver.stage import asked_of
from studio.library.scenes import carrying
from tests.builders import make_constraint, make_project

LEFT, RIGHT = (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True) for side in ("left", "right"))


@pytest.fixture(scope="module")
def carry() -> Project:
    project = carrying.three_boxes()
    frames = [(key, replace(each, clips=(replace(each.clips[0], last=240),)), None) for key, each in _players(project)]
    return project.with_entities("performers", frames)


def _players(project: Project) -> list:
    return list(project.performers.items())


def performed(project: Project) -> Staged:
    made = perform(project, project.performers, prepared, adapt)
    assert not made.failures
    return made


def sides_missed(project: Project, made: Staged) -> float:
    """Metres by which a wrist is beside its side of the box, at most."""
    worst = 0.0
    for key, each in made.performances.items():
        placement = Placement.of(project.performers[key])
        frames = each.played.frame_count
        holder = Holder(each.played, np.arange(frames), placement)
        prop = project.props[f"box {key}"]
        track = stage_track(prop, np.arange(frames) / 60.0, holder)
        for point, side in ((LEFT, 1.0), (RIGHT, -1.0)):
            wrist = placement.to_stage(place_of(point, each.played))
            asked = track.places + track.rotations @ (np.array([-0.7, side, 0.0]) * prop.size / 2)
            worst = max(worst, float(np.linalg.norm(wrist - asked, axis=1)[20:-20].max()))
    return worst


def test_wrists_lie_on_the_sides_of_their_boxes_on_every_body(carry: Project) -> None:
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
        frames = each.played.frame_count
        holder = Holder(each.played, np.arange(frames), Placement.of(carry.performers[key]))
        track = stage_track(carry.props[f"box {key}"], [0.0], holder)
        root = holder.placement.to_stage(each.played.positions[:, 0])
        away = np.einsum("fi,fi->f", track.places - root, track.rotations[:, :, 0]) / each.played.body.leg_length
        assert away.min() > 0.25
        assert away.max() < 0.7


def test_a_prop_without_keys_stays_and_one_with_keys_passes_them() -> None:
    still = stage_track(Prop("Box", position=(1.0, 2.0, 3.0), heading=0.5), [0.0, 1.0], None)
    assert still.places.tolist() == [[1.0, 2.0, 3.0]]
    keyed = Prop("Ball", position=KeyedPlace((0.0, 2.0), ((0, 0, 0), (2, 0, 1))), heading=KeyedNumber((1.0,), (0.3,)))
    track = stage_track(keyed, [0.0, 1.0, 2.0, 9.0], None)
    np.testing.assert_allclose(track.places, [[0, 0, 0], [1, 0, 0.5], [2, 0, 1], [2, 0, 1]], atol=1e-12)
    assert np.arctan2(track.rotations[:, 1, 0], track.rotations[:, 0, 0]) == pytest.approx(0.3)


def test_a_stick_in_a_hand_goes_where_the_hand_is_brought() -> None:
    project = make_project(characters=2, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND, (0.02, 0.0, 0.01))
    stick = Prop("Stick", (0.03, 0.03, 1.0), shape=PropShape.STICK, held=InHand("performer 0", hand))
    project = project.with_entity("props", "stick", stick)
    asked = make_constraint(point=LEFT, target=FollowProp("stick", share=(0.0, 0.0, 1.0)))
    project = project.with_entity("constraints", "tip", asked)
    own, other = (asked_of(project, key)[0].constraint for key in project.performers)
    assert isinstance(own.target, FollowBody)
    assert own.target.point.offset == pytest.approx((0.02, 0.0, 0.51))
    assert isinstance(other.target, FollowProp)
    made = performed(project)
    adapted = made.performances["performer 0"].adapted
    tip = place_of(own.target.point, adapted)
    turns = adapted.rotations[:, adapted.morphology.layout.segment(BodyPart.RIGHT_HAND)]
    np.testing.assert_allclose(tip - place_of(hand, adapted), 0.5 * turns[:, :, 2], atol=1e-9)
    track = made.performances["performer 1"].request.tracks[other.target]
    seen = Placement.of(project.performers["performer 1"]).to_stage(track.places)
    np.testing.assert_allclose(seen, Placement.of(project.performers["performer 0"]).to_stage(tip), atol=1e-9)


def test_a_hand_is_not_asked_to_follow_what_it_holds() -> None:
    project = make_project(characters=1, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    project = project.with_entity("props", "stick", Prop("Stick", held=InHand("performer 0", hand)))
    project = project.with_entity("constraints", "c", make_constraint(point=RIGHT, target=FollowProp("stick")))
    assert asked_of(project, "performer 0") == ()


def test_a_prop_that_goes_with_who_follows_in_turn_is_refused_in_a_sentence() -> None:
    project = make_project(characters=2, constraints=0)
    for name, holder in (("one", "performer 0"), ("other", "performer 1")):
        project = project.with_entity("props", name, Prop(name, held=InHand(holder, BodyPoint(BodyPart.RIGHT_HAND))))
        asked = make_constraint(point=LEFT, target=FollowProp(name))
        project = project.with_entity("constraints", name, asked)
    made = perform(project, project.performers, prepared, adapt)
    assert all("goes with" in reason for reason in made.failures.values())
    assert len(made.failures) == 2


def test_a_prop_that_is_turned_in_a_hand_turns_what_follows_it() -> None:
    turn = (0.0, 0.0, np.sin(0.4), np.cos(0.4))
    project = make_project(characters=1, constraints=0)
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    project = project.with_entity(
        "props", "stick", Prop("Stick", (1.0, 1.0, 1.0), held=InHand("performer 0", hand, turn))
    )
    asked = make_constraint(point=LEFT, target=FollowProp("stick", share=(1.0, 0.0, 0.0)))
    project = project.with_entity("constraints", "tip", asked)
    [found] = asked_of(project, "performer 0")
    assert found.constraint.target.point.offset == pytest.approx((0.5 * to_matrix(np.array(turn))[:, 0]).tolist())


def test_a_mesh_shape_without_a_mesh_is_refused() -> None:
    with pytest.raises(ValueError, match="load a mesh"):
        Prop("Thing", shape=PropShape.MESH)
