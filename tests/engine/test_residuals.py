"""One rule says by how much a constraint is missed, whichever view asks."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.performers.rows import composite_of
from studio.core.solver.request import AdaptedMotion
from studio.engine.live_adaptation import normalized_with_actor
from studio.engine.residuals import residuals_on, worst_residual
from studio.panels.constraint_editors.worst_residuals import residuals_of, words_of
from studio.timeline.strip_states import strip_of
from studio.viewport.problem import worst_problem
from tests.builders import make_constraint, make_contact, make_morphology, make_project

RATE, FRAMES = 60.0, 30
NOTHING = np.zeros((FRAMES, 1, 3))


def answer(*rows):
    return AdaptedMotion(make_morphology(), RATE, 0, NOTHING, NOTHING, np.array(rows, dtype=float))


def peaks(**at):
    row = np.zeros(FRAMES)
    for frame, metres in at.items():
        row[int(frame[1:])] = metres
    return row


def project_of(constraint, **parts):
    return make_project(characters=1, constraints=0, **parts).with_entity("constraints", "c", constraint)


def test_only_frames_count_in_which_the_constraint_is_fully_active():
    project = project_of(make_constraint())  # full from frame 6 to 18
    found = worst_residual(project, "performer 0", answer(peaks(f3=0.9, f10=0.04, f22=0.8)), "c")
    assert (found.amount, found.frame, found.fully_active, found.remark) == (0.04, 10, True, "")


def test_a_constraint_that_is_never_fully_active_is_judged_where_it_is_active_and_that_is_said():
    between = make_constraint(activation=ActivationCurve(0.0, 0.105, 0.107, 0.2))  # full between frames 6 and 7
    row = np.where(between.activation.at(np.arange(FRAMES) / RATE) > 0, peaks(f3=0.2), np.nan)
    found = worst_residual(project_of(between), "performer 0", answer(row), "c")
    assert (found.amount, found.frame, found.remark) == (0.2, 3, "never fully active")


def test_a_foot_is_judged_only_where_no_contact_holds_it():
    foot = make_constraint(point=BodyPoint(BodyPart.LEFT_FOOT, at_end=True))
    project = project_of(foot, contacts=0)
    row = answer(peaks(f8=0.3, f18=0.02))
    assert worst_residual(project, "performer 0", row, "c").frame == 8
    standing = make_contact(point=ContactPoint.LEFT_HEEL, first=0, last=8)
    held = project.with_entity("contacts", "heel", standing)
    assert worst_residual(held, "performer 0", row, "c").frame == 18


def test_frames_that_are_not_played_do_not_count():
    project = project_of(make_constraint())
    performer = project.performers["performer 0"]
    shorter = replace(performer, clips=(replace(performer.clips[0], first=9),))
    project = project.with_entity("performers", "performer 0", shorter)
    assert worst_residual(project, "performer 0", answer(peaks(f7=0.5, f12=0.1)), "c").frame == 12


def test_an_answer_to_an_older_question_is_not_read():
    project = project_of(make_constraint())
    assert residuals_on(project, "performer 0", answer(), "c") is None
    assert residuals_on(project, "performer 0", None, "c") is None
    assert worst_residual(project, "performer 0", answer(), "c") is None


def test_an_answer_to_a_row_of_other_clips_is_not_read_though_it_asks_as_much():
    project = project_of(make_constraint(), frames=FRAMES)
    performer = project.performers["performer 0"]
    [clip] = performer.clips
    motion = normalized_with_actor(next(iter(project.captures.values())))[0]

    def playing(*clips):
        return project.with_entity("performers", "performer 0", replace(performer, clips=clips))

    twice, after = playing(replace(clip, repeats=2)), playing(clip, replace(clip, start=5.0))
    composite = composite_of(twice, "performer 0", lambda _: motion)
    told = replace(answer(peaks(f10=0.04), peaks(f10=0.04)), composite=composite)
    assert residuals_on(twice, "performer 0", told, "c") is not None
    assert residuals_on(after, "performer 0", told, "c") is None
    assert worst_problem(after, lambda _: told) is None


def test_a_result_of_a_row_with_more_clips_tells_nothing_of_the_row_now():
    """A take that was recorded while a clip was added ended in an error of the viewport."""
    project = project_of(make_constraint())
    performer = project.performers["performer 0"]
    [clip] = performer.clips
    other = replace(clip, id="other", motion_id="elsewhere", start=clip.start + 1.0)
    motions = {**project.motions, "elsewhere": project.motions[clip.motion_id]}
    twice = replace(project, motions=motions, performers={"performer 0": replace(performer, clips=(clip, other))})
    motion = normalized_with_actor(project.captures["capture"])[0]
    composite = composite_of(twice, "performer 0", lambda _: motion)
    rows = np.full((1, composite.motion.frame_count), 0.04)
    nothing = np.zeros((rows.shape[1], 1, 3))
    told = replace(answer(), positions=nothing, rotations=nothing, residuals=rows, composite=composite)
    assert residuals_on(twice, "performer 0", told, "c") is not None
    assert residuals_on(project, "performer 0", told, "c") is None


def test_the_worst_frame_is_the_one_of_the_stage_in_the_repeat_in_which_it_is():
    """In the second repeat of a clip, the first one's frame was shown, where all is well."""
    project = project_of(make_constraint(name="Wrist"), frames=FRAMES)
    performer = project.performers["performer 0"]
    twice = replace(performer, clips=(replace(performer.clips[0], repeats=2),))
    project = project.with_entity("performers", "performer 0", twice)
    motion = normalized_with_actor(next(iter(project.captures.values())))[0]
    composite = composite_of(project, "performer 0", lambda _: motion)
    rows = np.full((2, composite.motion.frame_count), np.nan)
    rows[0, 10], rows[1, FRAMES - 1 + 12] = 0.01, 0.04
    nothing = np.zeros((rows.shape[1], 1, 3))
    told = replace(answer(), positions=nothing, rotations=nothing, residuals=rows, composite=composite)
    found = worst_residual(project, "performer 0", told, "c")
    assert (found.amount, found.frame, found.stage_frame) == (0.04, 12, 41)
    assert found.time == pytest.approx(41 / RATE)
    problem = worst_problem(project, lambda _: told)
    assert problem.sentence == "Body 0: 'Wrist' has an error of 40 mm at frame 41 (12 of the clip)"
    strip = strip_of(project, "performer 0", told, "c")
    assert (strip.error_at(41 / RATE), strip.error_at(10 / RATE)) == (0.04, 0.01)


def test_viewport_and_inspector_tell_the_same_number_and_frame():
    project = project_of(make_constraint(name="Wrist"))
    motion = answer(peaks(f3=0.9, f10=0.04))
    problem = worst_problem(project, lambda _: motion)
    [line] = residuals_of(project, SimpleNamespace(reported_motion=lambda _: motion, ready=True), "c")
    assert (problem.residual.amount, problem.residual.frame) == pytest.approx((line.worst.amount, line.worst.frame))
    assert problem.sentence == "Body 0: 'Wrist' has an error of 40 mm at frame 10"
    assert words_of(line) == "not met, 40 mm at 10"
