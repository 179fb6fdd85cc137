from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.timing import Timing
from studio.engine.residuals import Inactive, inactivity
from studio.panels.constraint_editors.worst_residuals import residuals_of, words_of
from studio.timeline.strip_states import ErrorStrip, StripState, strip_heights, strip_of
from tests.builders import make_constraint, make_contact, make_project
from tests.timeline.fakes import make_result


def make_strip(errors, activation=1.0):
    errors = np.asarray(errors, float)
    return ErrorStrip(Timing(0.0, 1.0, 0, len(errors) - 1), errors, np.broadcast_to(float(activation), errors.shape))


@pytest.mark.parametrize(
    ("error", "state"),
    [
        (0.0, StripState.HELD),
        (0.0009, StripState.HELD),
        (0.001, StripState.PARTLY),
        (0.0199, StripState.PARTLY),
        (0.020, StripState.NOT_REACHED),
    ],
)
def test_states_follow_the_error(error, state):
    assert make_strip([error]).state_at(0) == state


def test_before_it_begins_a_constraint_is_not_active():
    assert make_strip([np.nan], activation=0.0).state_at(0) == StripState.INACTIVE


def test_where_nothing_is_asked_of_an_active_constraint_it_gives_way():
    strip = make_strip([np.nan, 0.0])
    assert [strip.state_at(0), strip.state_at(1)] == [StripState.YIELDING, StripState.HELD]
    assert strip.yields
    assert not make_strip([0.0, 0.0]).yields


def test_outside_the_result_a_strip_says_nothing():
    strip = make_strip([0.0, 0.0])
    assert strip.state_at(-1) == strip.state_at(2) == StripState.INACTIVE
    assert np.isnan(strip.error_at(2))


def test_a_strip_grows_with_the_error_up_to_its_full_height():
    heights = strip_heights(np.array([0.0, 0.0005, 0.002, 0.02, 0.1, 5.0]), 5)
    assert heights[0] == heights[1] == 1
    assert (np.diff(heights) >= 0).all()
    assert heights[-2] == heights[-1] == 5


def test_a_constraint_gives_way_only_where_a_contact_holds_its_limb():
    """Frames that a cut clip does not play, or in which it has no time to fade, say nothing of contacts."""
    foot = make_constraint(point=BodyPoint(BodyPart.LEFT_FOOT, at_end=True))
    project = make_project(characters=1, constraints=0, contacts=0).with_entity("constraints", "c", foot)
    silent = make_result(project, {"c": np.nan})
    assert not strip_of(project, "performer 0", silent, "c").yields
    stands = project.with_entity("contacts", "heel", make_contact(point=ContactPoint.LEFT_HEEL, first=0, last=12))
    assert strip_of(stands, "performer 0", silent, "c").yields


def test_the_reason_is_told_why_a_constraint_acts_in_no_frame():
    """Before the clip, on a foot that stands, or because the clip is cut within its fade."""
    foot = make_constraint(point=BodyPoint(BodyPart.LEFT_FOOT, at_end=True))
    project = make_project(characters=1, constraints=0, contacts=0).with_entity("constraints", "c", foot)
    stands = project.with_entity("contacts", "heel", make_contact(point=ContactPoint.LEFT_HEEL, first=0, last=29))
    later = replace(foot, activation=ActivationCurve(60.0, 60.1, 60.3, 60.4))
    for asked, reason in (
        (project, Inactive.CUT),
        (stands, Inactive.OVERRIDDEN),
        (project.with_entity("constraints", "c", later), Inactive.ELSEWHERE),
    ):
        silent = make_result(asked, {"c": np.nan})
        [line] = residuals_of(asked, SimpleNamespace(reported_motion=lambda _, silent=silent: silent, ready=True), "c")
        assert inactivity(asked, "performer 0", silent, "c") is line.inactive is reason
        assert words_of(line) == reason


def test_residuals_are_found_by_priority_among_the_enabled_constraints():
    project = make_project(constraints=3)
    project = project.with_entity("constraints", "constraint 0", make_constraint(name="off", priority=0, enabled=False))
    result = make_result(project, {"constraint 1": 0.5, "constraint 2": 0.0})
    assert strip_of(project, "performer 0", result, "constraint 0") is None
    assert strip_of(project, "performer 0", result, "constraint 1").error_at(10 / 60) == 0.5
    assert strip_of(project, "performer 0", result, "constraint 2").error_at(10 / 60) == 0.0


def test_a_result_of_an_older_question_is_not_shown():
    project = make_project(constraints=1)
    result = make_result(project, {"constraint 0": 0.0})
    more = project.with_entity("constraints", "another", make_constraint(priority=1))
    assert strip_of(more, "performer 0", result, "constraint 0") is None
