"""Live play kept as clips: the timeline plays it as it was seen."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.constraints.scope import Scope
from studio.core.curves.keyed import KeyedPlace
from studio.core.quality.metrics import contact_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers, motion_of
from studio.core.stage.project import Project, new_id
from studio.library.scenes.sparring import PUNCH_KEYS
from studio.live.playing_stage import LiveStage
from studio.live.recorded_take import StageTake, edits_of
from tests.live.test_live_stage import STEP, WRIST, clip_of, prepare, reaching, staged
from tests.live.test_sparring import moved, scene


def with_take(project: Project, take: StageTake) -> Project:
    made = edits_of(take, project, lambda motion_id: motion_of(project, motion_id, prepare), iter(new_id, ""))
    for collection, key, entity in made:
        project = project.with_entity(collection, key, entity)
    return project


class Play:
    """Plays and records; what was seen, and at which seconds of the stage."""

    def __init__(self, project: Project) -> None:
        one = replace(project.performers["one"], clears=False)  # live, arms are not kept clear of what they are asked
        self.stage = LiveStage(project.with_entity("performers", "one", one), prepare)
        self.seen: list[tuple[float, np.ndarray]] = []

    def step(self, count: int = 1, dt: float = STEP) -> None:
        for _ in range(count):
            result = self.stage.step(dt)["one"]
            self.seen.append((self.stage.seconds, result.positions[0]))

    def misses(self) -> np.ndarray:
        """(F,) metres by which any point is elsewhere when the timeline plays the take."""
        take = self.stage.recorded()
        assert take is not None
        project = with_take(self.stage.project, take)
        made = adapt_performers(project, ["one"], prepare, lambda request: adapt(replace(request, eased=False)))
        one = made.performances["one"]
        timing = one.composite.timing
        frames = [(round(timing.frame_at(seconds)), seen) for seconds, seen in self.seen if seconds >= take.begin]
        self.taken = project
        return np.array([np.abs(one.adapted.positions[frame] - seen).max() for frame, seen in frames])


def test_a_row_that_nobody_touched_is_recorded_as_it_is():
    play = Play(staged(clip_of("walk_turn", 100, 160), clip_of("front_kick", 60, 120, 0.9)))
    play.step(1, 0.0)
    play.stage.record()
    play.step(80)
    assert play.misses().max() < 1e-6


def test_a_take_begins_where_it_is_put_on_the_timeline_and_plays_as_it_was_seen():
    """It landed when it was played, 28 s behind nothing."""
    play = Play(staged(clip_of("straight_punch", 60)))
    play.step(90)
    play.stage.record()
    play.step(10)
    play.stage.start("one", clip_of("front_kick", 64))
    play.step(90)
    take, begin = play.stage.recorded(), 0.5
    project = play.stage.project
    made = edits_of(take, project, lambda motion_id: motion_of(project, motion_id, prepare), iter(new_id, ""), begin)
    for collection, key, entity in made:
        project = project.with_entity(collection, key, entity)
    clips = project.performers["one"].clips
    assert clips[0].start == pytest.approx(begin, abs=STEP)
    assert clips[1].start == pytest.approx(begin + 10 * STEP, abs=1.5 * STEP)
    one = adapt_performers(
        project, ["one"], prepare, lambda request: adapt(replace(request, eased=False))
    ).performances["one"]
    timing = one.composite.timing
    frames = [
        (round(timing.frame_at(seconds + begin - take.begin)), seen)
        for seconds, seen in play.seen
        if seconds > take.begin + 0.8  # the first transition has less before it than when it was played
    ]
    assert max(np.abs(one.adapted.positions[frame] - seen).max() for frame, seen in frames) < 0.01


def test_who_came_to_play_nothing_in_a_take_keeps_its_row():
    play = Play(staged(clip_of("walk_turn", 100, 160)))
    play.step(1, 0.0)
    play.stage.record()
    play.step(10)
    take = play.stage.recorded()
    project = play.stage.project
    other = replace(project.performers["one"], name="Two")
    project = project.with_entity("performers", "two", other)
    assert with_take(project, take).performers["two"] == other


def test_a_take_is_as_it_was_seen_before_and_after_what_was_improvised():
    play = Play(staged(clip_of("straight_punch", 60)))
    play.step(1, 0.0)
    play.stage.record()
    play.step(40)
    play.stage.start("one", clip_of("front_kick", 64))
    play.step(140)
    misses = play.misses()
    assert misses[:30].max() < 5e-3
    assert misses[100:].max() < 1e-2  # it goes along with a foot that stands aside until that is lifted
    assert misses.max() < 0.06  # nobody knew of what was to come


def test_the_clips_of_a_take_are_where_and_when_they_played():
    play = Play(staged(clip_of("reach_grasp", 60)))
    play.step(1, 0.0)
    play.step(30)
    play.stage.record()
    play.step(30)
    play.stage.start("one", clip_of("front_kick", 120))
    play.step(30)
    play.misses()
    first, second = play.taken.performers["one"].clips
    assert (first.motion_id, first.first, first.last) == ("reach_grasp", 60, 120)
    assert (second.motion_id, second.first) == ("front_kick", 120)
    assert second.start == pytest.approx(61 * STEP)


def test_a_target_that_was_moved_is_keyed_in_the_clip():
    project = staged(clip_of("straight_punch", 60), reach=reaching("straight_punch", (0.4, -0.2, 1.1)))
    play = Play(project)
    play.step(1, 0.0)
    play.stage.record()
    for step in range(30):
        place = (0.4, -0.2 + 0.01 * step, 1.1)
        asked = reaching("straight_punch", place)
        play.stage.project = play.stage.project.with_entity("constraints", "reach", asked)
        play.step()
    misses = play.misses()
    assert isinstance(play.taken.constraints["reach"].target, KeyedPlace)
    assert misses[1:-12].max() < 5e-3  # at the end of a clip what is asked goes


def test_a_clip_that_played_twice_has_its_target_in_each_of_its_clips():
    project = staged(clip_of("straight_punch", 60), reach=reaching("straight_punch", (0.4, -0.2, 1.1)))
    play = Play(project)
    play.step(1, 0.0)
    play.stage.record()
    play.step(20)
    play.stage.start("one", clip_of("straight_punch", 100))
    play.step(20)
    asked = reaching("straight_punch", (0.4, 0.0, 1.2))
    play.stage.project = play.stage.project.with_entity("constraints", "reach", asked)
    play.step(20)
    play.misses()
    asked = play.taken.constraints
    assert not asked["reach"].enabled
    clips = {clip.id for clip in play.taken.performers["one"].clips}
    assert {each.scope.clip_id for key, each in asked.items() if key != "reach"} == clips


def test_what_was_asked_of_a_clip_alone_is_asked_of_what_was_recorded_of_it():
    own = reaching("straight_punch", (0.4, -0.2, 1.1), scope=Scope(clip_id="straight_punch clip"))
    play = Play(staged(clip_of("straight_punch", 60), reach=own))
    play.step(1, 0.0)
    play.stage.record()
    play.step(30)
    play.misses()
    [clip] = play.taken.performers["one"].clips
    assert any(each.scope.clip_id == clip.id and each.point == WRIST for each in play.taken.constraints.values())


def test_steps_to_keep_a_distance_are_in_the_take_where_they_were_played():
    project = moved(scene(), 2.2, 0.3)
    stage = LiveStage(project, prepare)
    stage.step(0.0)
    stage.record()
    seen = {key: [] for key in PUNCH_KEYS}
    for _ in range(150):
        for key, result in stage.step(STEP).items():
            seen[key].append(result.positions[0, 0])
    take = stage.recorded()
    taken = with_take(project, take)
    made = adapt_performers(taken, PUNCH_KEYS, prepare, lambda request: adapt(replace(request, eased=False)))
    assert not made.failures
    for key, roots in seen.items():
        one = made.performances[key]
        timing = one.composite.timing
        frames = [round(timing.frame_at(take.begin + (step + 1) * STEP)) for step in range(len(roots))]
        misses = np.linalg.norm(one.adapted.positions[frames, 0] - np.array(roots), axis=1)
        assert np.linalg.norm(roots[-1] - roots[0]) > 0.2
        assert misses[-20:].max() < 0.01
        assert misses.max() < 0.12  # nobody knew of what was to come
        assert contact_quality(one.adapted_on_stage, one.adapted.contacts, taken.ground).slide < 1e-3
