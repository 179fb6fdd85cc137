"""Clips that take over at any frame, without warning: by chance, and where bodies turn over."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studio.core.body.morphology import sole_rows
from studio.core.grounds.slope import Slope
from studio.core.kernels.support.sole import HEEL_STANDS, TOE_STANDS
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.runs import runs_of
from studio.core.solver.grounding.held_foot import heel_pivot
from studio.core.solver.grounding.stepping import flights_of
from studio.core.solver.grounding.swing_foot_path import Sole
from studio.core.stage.clip import Clip
from studio.core.stage.project import GROUND_ID
from studio.library.scenes.stagehand import source_motions
from studio.live.playing import row_motion
from studio.live.playing_stage import LiveStage
from tests.live.test_live_stage import CHANGE, PERMITTED, STEP, Shown, cast, changed, clip_of, prepare, staged, stuff


@cache
def turned_over():
    names = ("straight_punch", "cartwheel")
    return source_motions(**{name: (name, name) for name in names})


def turning(name: str, first: int) -> Clip:
    return Clip(name, first, turned_over().captures[name].frame_count - 1, 0.0, f"{name} clip")


def jolt_of(shown: Shown, first: Clip, second: Clip, body: str) -> float:
    """The sharpest that a joint turns where ``second`` takes over, beside its own sharpest in either clip."""
    peaks = [
        row_motion(staged(replace(each, first=0), body=body), "one", prepare).standing.peak_angular_accelerations
        for each in (first, second)
    ]
    usual = np.maximum(np.maximum(*peaks), QUIET_PEAK)
    return float((shown.accelerations()[CHANGE - 4 :].max(axis=0) / usual).max())


def picked(count: int) -> list[tuple[list[Clip], str]]:
    """Two clips from any of their frames on, and a body, by chance."""
    chance = np.random.default_rng(19)
    names = ("walk_turn", "front_kick", "straight_punch", "reach_grasp")
    found = []
    for index in range(count):
        chosen = [
            (str(name), stuff().captures[name].frame_count - room)
            for name, room in zip(chance.choice(names, 2), (40, 80), strict=True)
        ]
        clips = [clip_of(name, int(chance.integers(0, last))) for name, last in chosen]
        found.append((clips, list(cast())[index % 5]))
    return found


@cache
def by_chance() -> list[tuple[float, float]]:
    """Acceleration of joints and slide of standing feet where clips take over at 48 frames."""
    found = []
    for clips, body in picked(48):
        shown = changed(*clips, body)
        found.append((jolt_of(shown, *clips, body), slide_of(shown)))
    return found


def slide_of(shown: Shown) -> float:
    """Metres over the ground that a heel that stands is away from where it came down, or a toe, by its ball or the tip
    over which it rolls, goes in a frame, at most.
    """
    body = shown.stage.results[shown.key].morphology
    positions, rotations, worst = np.array(shown.positions), np.array(shown.rotations), 0.0
    for side in range(2):
        ankle, foot = body.layout.ankle_point(side), body.layout.spine_count + 12 + 4 * side
        pad = heel_pivot(sole_rows(body, side)).offsets(rotations[:, foot], rotations[:, foot + 1])
        heels = (positions[:, ankle] + pad)[:, :2]
        toes = np.linalg.norm(np.diff(positions[:, ankle + 1 : ankle + 3, :2], axis=0), axis=2).min(axis=1)
        for first, stop in _stands(shown, ankle):
            worst = max(worst, np.linalg.norm(heels[first:stop] - heels[first], axis=1).max())
        for first, stop in _stands(shown, ankle + 1):
            worst = max(worst, toes[first : stop - 1].max(initial=0.0))
    return float(worst)


def _stands(shown: Shown, point: int) -> list[tuple[int, int]]:
    """(first, past the last) of each time that a point stands, from the last frame before the change on."""
    runs = runs_of(np.array([point in each for each in shown.standing]))
    return [(max(first, CHANGE - 1), stop) for first, stop in runs if stop >= CHANGE]


def test_of_takeovers_at_any_frame_few_are_sharper_than_permitted_and_none_jolts():
    """Of 48 by chance 11 were, an arm turned 34 times as sharply as ever in its clips."""
    jolts = np.array([jolt for jolt, _ in by_chance()])
    assert np.mean(jolts > PERMITTED) < 1.0 / 6.0  # those whose foot would go on into the ground among them
    assert jolts.max() < 6.0


def test_what_stands_does_not_slide_where_a_clip_takes_over_at_any_frame():
    """Heels that came down while the foot still turned slid by up to 12 cm, one in six takeovers."""
    assert max(slide for _, slide in by_chance()) < 1e-3


def test_no_foot_goes_into_the_ground_as_a_clip_takes_over_and_none_stands_above_it():
    """Of 60 by chance 18 did by more than 5 mm, one by 97, and a heel that stood was 133 mm high."""
    for clips, body in picked(24):
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
                standing = [heights[place] for place, bit in ((0, HEEL_STANDS), (1, TOE_STANDS)) if state & bit]
                assert max(standing, default=0.0) < 0.03


def sole_heights(result, side: int) -> np.ndarray:
    """Metres above the level floor of heel to tip, toes under their ball."""
    body, layout = result.morphology, result.morphology.layout
    leg = layout.spine_count + 10 + 4 * side
    foot, toe = (result.rotations[:1, leg + part] for part in (2, 3))
    return Sole.of(result.positions[:1, layout.ankle_point(side)], foot, toe, sole_rows(body, side)).points[
        0, [0, 4, -1], 2
    ]


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


def test_a_foot_steps_while_the_other_stands_or_goes_to_its_place_as_the_motion_lifts_it():
    """One stepped while the other was in a kick: the body flew."""
    kick, stand = np.repeat([3, 0, 3], [20, 40, 60]), np.full(120, 3)
    ways, needed = np.array([0.0, 0.2]), np.full((2, 2), 0.3)
    _, stepping = flights_of(np.array([kick, stand]), np.array([3, 3]), ways, needed, 0.0, 60.0)
    assert stepping.height > 0.0
    assert stepping.leaves >= 60
    lifted = np.repeat([3, 0, 3], [15, 30, 75])
    _, led = flights_of(np.array([kick, lifted]), np.array([3, 3]), ways, needed, 0.0, 60.0)
    assert (led.leaves, led.height) == (15, 0.0)


def test_whose_motion_or_clip_is_taken_away_goes_on_from_where_it_is():
    """The row began again, up to a metre away."""
    walk, kick = clip_of("walk_turn", 60, 200), clip_of("front_kick", 60, 300, 2.3)
    for gone in (walk, kick):
        project = staged(walk, kick)
        shown = Shown(LiveStage(project, prepare, 0.5 if gone is walk else 3.0))
        shown.step(1, 0.0)
        shown.step(20)
        left = tuple(each for each in (walk, kick) if each is not gone)
        without = project.with_entity("performers", "one", replace(project.performers["one"], clips=left))
        motions = {key: each for key, each in project.motions.items() if key != gone.motion_id}
        shown.stage.project = replace(without, motions=motions, contacts=without.contacts)
        shown.step(30)
        ways = np.linalg.norm(np.diff(np.array(shown.positions), axis=0), axis=2).max(axis=1)
        assert ways[20] < ways[19] + 0.02
        assert shown.stage.staged.performers["one"].clips[0].motion_id == left[0].motion_id
