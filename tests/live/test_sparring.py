"""Two fighters that behave: they keep their distance, ward off and lean away, and their feet stand while they do."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studio.core.captures.capture import Capture
from studio.core.captures.contacts import touching_points
from studio.core.captures.reaching import farthest_reach_frame
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.behaviour_target import PELVIS_POINT
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.core.stage.reactions import ARM_POINT, FIST_POINT, HEAD_POINT, KeepDistance, LeanAway
from studio.jobs.performances import prepared_capture
from studio.library.scenes import fight
from studio.library.scenes.sparring import (
    ARM_STRETCHED_FRAME,
    HEAD_CLEARANCE,
    PUNCH_HIT_SECONDS,
    PUNCH_KEYS,
    SPARRING_DISTANCE,
    sparring,
)
from studio.live.playing_stage import LiveStage

STEP = 1.0 / 60.0
ONE, OTHER = PUNCH_KEYS
_known: dict[int, tuple[Capture, tuple]] = {}


def prepare(capture: Capture):
    if id(capture) not in _known:
        _known[id(capture)] = capture, prepared_capture(capture)
    return _known[id(capture)][1]


@cache
def scene() -> Project:
    return sparring()


class Fight:
    """A stage, and where points of both were in every step."""

    def __init__(self, project: Project) -> None:
        self.stage = LiveStage(project, prepare)
        self.stage.step(0.0)

    def play(self, seconds: float, *keys: str):
        """Yield after every step, with the keys pressed in the first one."""
        for key in keys:
            self.stage.press(key)
        for _ in range(round(seconds / STEP)):
            self.stage.step(STEP)
            assert not self.stage.failures
            yield

    def at(self, key, point):
        placement = Placement.of(self.stage.project.performers[key])
        return placement.to_stage(body_point_positions(point, self.stage.results[key])[0])

    def apart(self, point=PELVIS_POINT, other=PELVIS_POINT, one_key=ONE, other_key=OTHER):
        return float(np.linalg.norm(self.at(one_key, point) - self.at(other_key, other)))

    def distance(self):
        return float(np.linalg.norm((self.at(ONE, PELVIS_POINT) - self.at(OTHER, PELVIS_POINT))[:2]))

    def facing(self, key, other):
        """Radians by which a fighter's chest is turned away from the other, its stance aside."""
        away = (self.at(other, PELVIS_POINT) - self.at(key, PELVIS_POINT))[:2]
        return np.arctan2(away[1], away[0])

    def state(self, key):
        return self.stage.running[key].state


def moved(project: Project, x: float, y: float) -> Project:
    """The other fighter stands somewhere else."""
    return project.with_entity("performers", OTHER, replace(project.performers[OTHER], position=(x, y)))


@pytest.mark.parametrize("place", [(1.0, 0.0), (2.4, 0.0), (1.2, 1.2)])
def test_from_wherever_they_begin_they_come_to_their_distance_and_stay_there(place):
    fight = Fight(moved(scene(), *place))
    for _ in fight.play(4.0):
        pass
    room = next(each.room for each in scene().behaviours[ONE].states[0].manners if isinstance(each, KeepDistance))
    for _ in fight.play(2.0):
        assert abs(fight.distance() - SPARRING_DISTANCE) < room + 0.05


def test_who_is_followed_on_foot_keeps_who_follows_at_a_distance():
    fight = Fight(scene())
    for _ in fight.play(2.0):
        pass
    for metres in (0.3, 0.6, 0.9):
        fight.stage.project = moved(scene(), SPARRING_DISTANCE + metres, 0.2)
        for _ in fight.play(2.5):
            pass
        assert abs(fight.distance() - SPARRING_DISTANCE) < 0.2


def test_no_foot_slides_while_it_stands_however_they_step():
    fight = Fight(moved(scene(), 2.4, 0.3))
    before: dict[tuple[str, int], np.ndarray] = {}
    worst = 0.0
    for _ in fight.play(4.0):
        now = {}
        for key, result in fight.stage.results.items():
            for contact in result.composite.contacts:
                if contact.point.is_foot and contact.first <= result.first_frame <= contact.last:
                    heel_or_ball = touching_points(contact.point, result.morphology.layout)[0]
                    now[key, heel_or_ball] = result.positions[0, heel_or_ball]
        slides = [float(np.linalg.norm(place - before[each])) for each, place in now.items() if each in before]
        worst, before = max([worst, *slides]), now
    assert worst < 1e-3


@pytest.mark.parametrize(("one", "other"), [(ONE, OTHER), (OTHER, ONE)])
def test_a_forearm_meets_the_fist_of_a_low_punch(one, other):
    fight = Fight(scene())
    for _ in fight.play(3.0):
        pass
    nearest = [
        fight.apart(FIST_POINT, ARM_POINT, one, other) for _ in fight.play(2.0 * PUNCH_HIT_SECONDS, PUNCH_KEYS[one][0])
    ]
    assert fight.state(other) in ("Ward off", "Guard")
    assert min(nearest) < 5e-3
    assert np.argmin(nearest) * STEP == pytest.approx(PUNCH_HIT_SECONDS, abs=0.1)


@pytest.mark.parametrize(("one", "other"), [(ONE, OTHER), (OTHER, ONE)])
def test_a_head_leans_away_from_a_high_punch_that_would_come_nearer(one, other):
    def nearest(project):
        fight = Fight(project)
        for _ in fight.play(3.0):
            pass
        return min(
            fight.apart(FIST_POINT, HEAD_POINT, one, other)
            for _ in fight.play(2.0 * PUNCH_HIT_SECONDS, PUNCH_KEYS[one][1])
        )

    assert nearest(scene()) > HEAD_CLEARANCE - 5e-3
    assert nearest(stiff(scene())) < HEAD_CLEARANCE - 0.05


def stiff(project: Project) -> Project:
    """Nobody leans away."""
    for key, behaviour in project.behaviours.items():
        states = tuple(
            replace(state, manners=tuple(each for each in state.manners if not isinstance(each, LeanAway)))
            for state in behaviour.states
        )
        project = project.with_entity("behaviours", key, replace(behaviour, states=states))
    return project


@cache
def training_fight() -> tuple[Project, list[dict[str, AdaptedMotion]]]:
    """Eight fighters, each in each of 180 steps after X is pressed; all are in guard then."""
    project = fight.fight_training()
    stage = LiveStage(project, prepare)
    for step in range(90):
        stage.step(STEP if step else 0.0)
    stage.press("X")
    steps = []
    for _ in range(180):
        steps.append(dict(stage.step(STEP)))
        assert not stage.failures
    assert {each.state for each in stage.running.values()} == {"Guard"}
    return project, steps


def test_eight_fighters_kick_ward_off_and_punch_by_two_behaviours_that_fit_all_bodies():
    project, steps = training_fight()
    pairs = list(zip(*[iter(project.performers)] * 2, strict=True))
    met, hit = ({pair: [] for pair in pairs} for _ in range(2))
    for results in steps:
        for white, red in pairs:
            for gaps, own, other in (
                (met, fight.WARDING_FOREARM_POINT, fight.KICKING_ANKLE_POINT),
                (hit, fight.RIGHT_FIST_POINT, fight.CHIN_POINT),
            ):
                places = [
                    Placement.of(project.performers[key]).to_stage(body_point_positions(point, results[key])[0])
                    for key, point in ((red, own), (white, other))
                ]
                gaps[white, red].append(float(np.linalg.norm(places[0] - places[1])))
    assert [min(gaps) < 5e-3 for gaps in met.values()] == [True] * 4
    assert [min(gaps) < 5e-3 for gaps in hit.values()] == [True] * 4


def test_who_is_too_far_does_not_strike():
    fight = Fight(moved(scene(), 3.5, 0.0))
    for _ in fight.play(0.1, PUNCH_KEYS[ONE][0]):
        assert fight.state(ONE) == "Guard"


def test_the_punch_is_found_to_hit_where_its_arm_is_stretched_most():
    assert farthest_reach_frame(scene().captures["straight_punch"], 140, 230) == pytest.approx(
        ARM_STRETCHED_FRAME, abs=3
    )


def test_who_wards_off_meets_the_kick_and_does_not_chase_it():
    project, steps = training_fight()
    for key in (each.performer_id for each in project.behaviours["red"].cast):
        turns = []
        for result in (results[key] for results in steps[:120]):
            carriers = np.array(result.morphology.layout.parent_segments())[1:]
            turns.append(np.swapaxes(result.rotations[0, carriers], 1, 2) @ result.rotations[0, 1:])
        assert angular_acceleration(np.array(turns), 1.0 / STEP).max() < 2000.0
