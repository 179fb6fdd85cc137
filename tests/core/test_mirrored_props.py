"""Props held in mirrored clips: the hands lie on them as those of the unmirrored clip do, reflected."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.performing import adapt_performers
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.holding import grip_constraints
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, InHand, Prop
from studio.document.mirrored import mirrored_edit, mirrored_project
from studio.jobs.performances import prepared_capture
from studio.library.scenes import carrying
from tests.builders import make_character, make_constraint

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
    constraints = {str(place): replace(each, motion_id=walk.motion_id) for place, each in enumerate(asked)}
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
    project = own_of(carrier(hold, asked=grips(turned, elevation=0.4), clip=clip))
    assert_reflected(project, with_mirrored(project), tolerance=1e-6)


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
    project = replace(project, props={"box": box}, constraints={str(place): each for place, each in enumerate(asked)})
    clips = [
        (key, replace(each, clips=(replace(each.clips[0], offset=(0.2, 0.0)),)), None)
        for key, each in project.performers.items()
    ]
    project = project.with_entities("performers", clips)
    assert_reflected(project, with_mirrored(project))


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
