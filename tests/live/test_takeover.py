"""Clips that take over at any frame, without warning: by chance, and where bodies turn over."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studio.core.body.morphology import sole_rows
from studio.core.grounds.slope import Slope
from studio.core.kernels.support.sole import HEEL, TOE
from studio.core.project import GROUND_ID
from studio.core.quality.metrics import QUIET
from studio.core.solver.standing.swing import Sole
from studio.core.stage.clip import Clip
from studio.library.scenes.stagehand import material
from studio.live.playing import own_row
from studio.live.stage import LiveStage
from tests.live.test_live_stage import CHANGE, PERMITTED, STEP, cast, changed, clip_of, prepare, staged, stuff


@cache
def turned_over():
    names = ("straight_punch", "cartwheel")
    return material(**{name: (name, name) for name in names})


def turning(name: str, first: int) -> Clip:
    return Clip(name, first, turned_over().captures[name].frame_count - 1, 0.0, f"{name} clip")


def jolt_of(first: Clip, second: Clip, body: str) -> float:
    """The sharpest that a joint turns where ``second`` takes over, beside its own sharpest in either clip."""
    shown = changed(first, second, body)
    peaks = [
        own_row(staged(replace(each, first=0), body=body), "one", prepare).standing.peaks for each in (first, second)
    ]
    usual = np.maximum(np.maximum(*peaks), QUIET)
    return float((shown.accelerations()[CHANGE - 4 :].max(axis=0) / usual).max())


def test_of_takeovers_at_any_frame_few_are_sharper_than_permitted_and_none_jolts():
    """Of 48 by chance 11 were, an arm turned 34 times as sharply as ever in its clips."""
    jolts = np.array([jolt_of(*clips, body) for clips, body in by_chance(48)])
    assert np.mean(jolts > PERMITTED) < 1.0 / 6.0  # those whose foot would go on into the ground among them
    assert jolts.max() < 5.0


def test_no_foot_goes_into_the_ground_as_a_clip_takes_over_and_none_stands_above_it():
    """Of 60 by chance 18 did by more than 5 mm, one by 97, and a heel that stood was 133 mm high."""
    for clips, body in by_chance(24):
        stage = LiveStage(staged(clips[0], body=body), prepare)
        for _ in range(20):
            stage.step(STEP)
        stage.start("one", clips[1])
        for _ in range(60):
            result = stage.step(STEP)["one"]
            frame, states = result.first_frame, stage._parts["one"].playing.standing.footing.states
            for side in range(2):
                heights = sole_heights(result, side)
                assert heights.min() > -6e-3
                state = states[side, frame]
                standing = [heights[place] for place, bit in ((0, HEEL), (1, TOE)) if state & bit]
                assert max(standing, default=0.0) < 0.03


def by_chance(count: int) -> list[tuple[list[Clip], str]]:
    """Two clips from any of their frames on, and a body."""
    chance = np.random.default_rng(19)
    names = ("walk_turn", "front_kick", "straight_punch", "reach_grasp")
    found = []
    for place in range(count):
        chosen = [
            (str(name), stuff().captures[name].frame_count - room)
            for name, room in zip(chance.choice(names, 2), (40, 80), strict=True)
        ]
        clips = [clip_of(name, int(chance.integers(0, last))) for name, last in chosen]
        found.append((clips, list(cast())[place % 5]))
    return found


def sole_heights(result, side: int) -> np.ndarray:
    """Metres above the level floor of heel to tip, toes under their ball."""
    body, layout = result.morphology, result.morphology.layout
    leg = layout.spine_count + 10 + 4 * side
    foot, toe = (result.rotations[:1, leg + part] for part in (2, 3))
    return Sole.of(result.positions[:1, layout.ankle(side)], foot, toe, sole_rows(body, side)).points[0, [0, 4, -1], 2]


@pytest.mark.parametrize("body", ["adult_woman", "giant"])
@pytest.mark.parametrize("slope", [0.0, 0.15])
def test_who_turns_over_stays_where_it_is(body, slope):
    """From a punch into a cartwheel a body fell through the floor, by 174 metres."""
    project = staged(turning("straight_punch", 150), body=body)
    project = replace(project, captures=turned_over().captures, motions=turned_over().motions)
    if slope:
        project = project.with_entity("grounds", GROUND_ID, Slope(slope))
    stage = LiveStage(replace(project, contacts=turned_over().contacts), prepare)
    for first in (166, 60, 99):
        stage.start("one", turning("cartwheel", first))
        for _ in range(40):
            places = stage.step(STEP)["one"].positions[0]
            assert np.abs(places[0]).max() < 4.0
