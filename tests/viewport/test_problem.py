from dataclasses import replace

import numpy as np
import pytest

from studio.viewport.problem import worst_problem
from tests.builders import make_constraint, make_project
from tests.viewport.standing import RATE, results_of, standing


def test_the_worst_miss_of_a_fully_active_constraint_is_told_with_its_frame():
    project = make_project(characters=2)
    results = results_of(project)
    problem = worst_problem(project, results.get)
    assert problem is not None
    frames = np.arange(30)
    full = (frames / RATE >= 0.1) & (frames / RATE <= 0.3)
    worst = {key: np.where(full, motion.residuals[0], 0.0) for key, motion in results.items()}
    key = max(worst, key=lambda one: worst[one].max())
    assert (problem.performer_id, problem.residual.stage_frame) == (key, int(worst[key].argmax()))
    assert problem.residual.amount == pytest.approx(worst[key].max())
    assert problem.residual.time == pytest.approx(problem.residual.stage_frame / RATE)
    assert problem.sentence.endswith(f"at frame {problem.residual.stage_frame}")


def test_no_problem_is_told_when_every_constraint_holds_or_none_is_asked():
    project = make_project(characters=1, constraints=0)
    assert worst_problem(project, results_of(project).get) is None
    motion = standing(project, "performer 0")
    target = tuple(motion.positions[12, motion.morphology.layout.wrist_point(1)].tolist())
    held = make_constraint(target=target)
    project = project.with_entity("constraints", "held", held)
    residuals = np.full((1, 30), 0.0004)
    results = {"performer 0": replace(motion, residuals=residuals)}
    assert worst_problem(project, results.get) is None


def test_an_answer_to_an_older_question_is_not_read_as_a_problem():
    project = make_project(characters=1, constraints=1)
    results = results_of(project)
    asked_more = project.with_entity("constraints", "new", make_constraint(name="New", priority=3))
    assert worst_problem(asked_more, results.get) is None
