"""Handles of constraints in the view: the lines that lead to targets."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber
from studio.core.rotations import from_matrix
from studio.engine.posed_performer import posed_performers
from studio.viewport.body_points import point_path
from studio.viewport.handles import Handle, constraint_handles
from tests.builders import make_constraint, make_project
from tests.viewport.standing import results_of

FALLING, RISING = KeyedNumber((0.1, 0.3), (1.0, 0.0)), KeyedNumber((0.1, 0.3), (0.0, 1.0))
HALF_WAY, HANDED_OVER = 0.2, 0.3


@pytest.fixture
def stage():
    return make_project(characters=1, constraints=0)


def handles_at(project, time) -> dict[str, Handle]:
    posed = posed_performers(project, results_of(project).get, time)
    return {each.constraint_id: each for each in constraint_handles(project, posed, "performer 0")}


def wrist_at(project, time):
    [pose] = posed_performers(project, results_of(project).get, time).values()
    point = make_constraint().point
    return pose.clip_placement.to_stage(
        pose.points_in_clip(point_path(pose.motion, point, slice(pose.row, pose.row + 1))[0])
    )


def pulled_between(project, time, ahead=0.0):
    """Two targets 0.4 m to both sides of the wrist at ``time``, or of a place ``ahead`` of it; their weights cross."""
    here = wrist_at(project, time) + np.array([ahead, 0.0, 0.0])
    for key, side, weight in (("one", 0.4, FALLING), ("other", -0.4, RISING)):
        target = tuple((here + np.array([0.0, side, 0.0])).tolist())
        one = make_constraint(name=key, target=target, weight=weight, activation=ActivationCurve(0.0, 0.0, 0.5, 0.5))
        project = project.with_entity("constraints", key, one)
    return project, here


def test_no_red_line_leads_from_a_hand_where_crossing_weights_put_it_half_way(stage):
    project, here = pulled_between(stage, HALF_WAY)
    for handle in handles_at(project, HALF_WAY).values():
        assert not handle.is_missed
        [line] = handle.figure.lines
        assert line == pytest.approx(np.stack([here, handle.target]), abs=1e-9)


def test_a_red_line_leads_to_where_crossing_weights_ask_a_hand_to_be(stage):
    project, goal = pulled_between(stage, HALF_WAY, ahead=0.1)
    for handle in handles_at(project, HALF_WAY).values():
        assert handle.is_missed
        assert handle.figure.link == pytest.approx(np.stack([goal - [0.1, 0.0, 0.0], goal]), abs=1e-9)


def test_no_line_leads_to_a_target_that_has_handed_the_hand_over(stage):
    project, _ = pulled_between(stage, HANDED_OVER)
    handles = handles_at(project, HANDED_OVER)
    assert handles["one"].figure.lines == ()
    assert handles["one"].figure.link[1] == pytest.approx(handles["other"].target, abs=1e-9)


def test_a_dragged_target_shares_its_goal_with_one_that_is_not_looked_at(stage):
    project, _ = pulled_between(stage, HALF_WAY)
    posed = posed_performers(project, results_of(project).get, HALF_WAY)
    [handle] = constraint_handles(project, posed, "performer 0", only={"one"})
    assert not handle.is_missed


def test_targets_of_constant_weights_are_each_missed(stage):
    project, _ = pulled_between(stage, HALF_WAY)
    for key in ("one", "other"):
        project = project.with_entity("constraints", key, replace(project.constraints[key], weight=1.0))
    assert all(each.is_missed for each in handles_at(project, HALF_WAY).values())


def test_the_axes_of_orientations_whose_weights_cross_are_red_only_if_the_blend_is_missed(stage):
    [pose] = posed_performers(stage, results_of(stage).get, HALF_WAY).values()
    part = BodyPart.RIGHT_HAND
    now = pose.rotation_in_clip(part)

    def asked(angles):
        project = stage
        for key, angle, weight in zip(("one", "other"), angles, (FALLING, RISING), strict=True):
            c, s = np.cos(angle), np.sin(angle)
            turn = now @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            one = OrientationConstraint(
                "motion", key, BodyPoint(part), Chain(), 0, ActivationCurve(0.0, 0.0, 0.5, 0.5),
                target=tuple(from_matrix(turn).tolist()), weight=weight,
            )  # fmt: skip
            project = project.with_entity("constraints", key, one)
        return [each.is_missed for each in handles_at(project, HALF_WAY).values()]

    assert asked((-0.5, 0.5)) == [False, False]
    assert asked((-0.5, 0.9)) == [True, True]
