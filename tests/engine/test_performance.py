from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.solver.performers.rows import timing_of
from studio.core.stage.clip import Clip
from studio.core.stage.placement import Placement
from studio.engine.posed_performer import PosedPerformer, motion_time, posed_performers, row_at, stage_time
from tests.builders import make_project
from tests.viewport.standing import FRAMES, RATE, results_of

small = st.floats(-10, 10)


@given(small, small, st.floats(-7, 7), st.tuples(small, small, small))
def test_a_placement_and_back_is_where_it_was(x, y, heading, point):
    place = Placement((x, y), heading)
    assert place.to_motion(place.to_stage(point)) == pytest.approx(np.array(point), abs=1e-9)


def test_a_clip_begun_later_and_trimmed_plays_its_own_frames():
    clip = Clip("motion", first=10, last=20, start=2.0)
    assert motion_time(clip, RATE, 2.0) == pytest.approx(10 / RATE)
    assert motion_time(clip, RATE, 2.0 + 5 / RATE) == pytest.approx(15 / RATE)
    assert motion_time(clip, RATE, 99.0) == pytest.approx(20 / RATE)
    assert stage_time(clip, RATE, 15 / RATE) == pytest.approx(2.0 + 5 / RATE)


def test_before_and_after_its_clip_a_performer_holds_the_first_and_last_pose():
    project = make_project(characters=1)
    motion = results_of(project)["performer 0"]
    timing = timing_of(project, project.performers["performer 0"])
    assert [row_at(motion, timing, time) for time in (-5.0, 3 / RATE, 60.0)] == [0, 3, FRAMES - 1]


def test_hidden_performers_and_those_without_a_result_are_not_posed():
    project = make_project(characters=3)
    hidden = replace(project.performers["performer 1"], visible=False)
    project = project.with_entity("performers", "performer 1", hidden)
    results = results_of(project)
    del results["performer 2"]
    assert list(posed_performers(project, results.get, 0.0)) == ["performer 0"]


def test_a_performers_points_stand_where_it_is_placed():
    project = make_project(characters=2)
    posed = posed_performers(project, results_of(project).get, 0.0)
    assert posed["performer 1"].points[0, :2] == pytest.approx([0.0, 1.2])


def row_of_two(*grips, change=60):
    """A performer at any frame of a row whose second clip takes over at frame ``change``."""
    project = make_project(characters=1)
    motion = results_of(project)["performer 0"]
    clips = tuple(Clip("motion", 0, 5, index, grip=grip) for index, grip in enumerate(grips))
    performer = replace(project.performers["performer 0"], clips=clips)
    played = [SimpleNamespace(first=index * change, piece=SimpleNamespace(origin=(index, 0))) for index in range(2)]
    composite = SimpleNamespace(
        played=played, fingers_before=None, timing=SimpleNamespace(frame_rate=motion.frame_rate)
    )
    adapted = SimpleNamespace(first_frame=0, frame_rate=motion.frame_rate, composite=composite)
    return [PosedPerformer(performer, adapted, frame, Placement()).grip(0.25) for frame in range(2 * change)]


def test_hands_are_held_as_the_clip_says_or_as_the_character_has_them():
    assert set(row_of_two(None, None)) == {0.25}
    assert row_of_two(1.0, None)[0] == 1.0
    assert row_of_two(1.0, None)[-1] == 0.25


def test_hands_close_little_by_little_from_one_clip_to_the_next():
    grips = np.array(row_of_two(-1.0, 1.0))
    assert (grips[0], grips[-1]) == (-1.0, 1.0)
    steps = np.diff(grips)
    assert (steps >= 0.0).all()
    assert steps.max() < 0.5
