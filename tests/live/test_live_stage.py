"""A stage played live: as the timeline has it until something is decided, then without a jump, a slide or a wait."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import touching_points
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowPerformer, FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.slope import Slope
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.behaviour_target import FollowPartner
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import (
    ClipEndCondition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.correction import PoseOffsets, new_correction
from studio.core.stage.placement import Placement
from studio.core.stage.project import GROUND_ID, Performer, Project
from studio.core.stage.prop import Prop
from studio.core.stage.reactions import Meet
from studio.jobs.performances import prepared_capture
from studio.library.scenes.stagehand import source_motions, varied_characters
from studio.live.playing import row_motion
from studio.live.playing_stage import LiveStage

STEP = 1.0 / 60.0
WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
LEFT_WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
ALWAYS = ActivationCurve(-1.0, 0.0, 100.0, 101.0)
PERMITTED = 1.5
CHANGE = 30
"""The step in which another clip takes over."""


@cache
def stuff():
    names = ("walk_turn", "front_kick", "straight_punch", "reach_grasp")
    return source_motions(**{name: (name, name) for name in names})


@cache
def cast():
    return varied_characters(5)


_known: dict[int, tuple[Capture, tuple]] = {}


def prepare(capture: Capture):
    if id(capture) not in _known:
        _known[id(capture)] = capture, prepared_capture(capture)
    return _known[id(capture)][1]


def clip_of(name: str, first: int = 0, last: int | None = None, start: float = 0.0) -> Clip:
    frames = stuff().captures[name].frame_count
    return Clip(name, first, frames - 1 if last is None else last, start, f"{name} clip")


def staged(*clips: Clip, body: str = "adult_woman", **constraints: PositionConstraint) -> Project:
    one = Performer("One", body, clips)
    return Project(stuff().captures, stuff().motions, cast(), {"one": one}, constraints, stuff().contacts)


def reaching(motion: str, place: tuple[float, float, float], **changes: object) -> PositionConstraint:
    return replace(
        PositionConstraint(motion, "Reach", WRIST, Chain(trunk=0.5, root=0.5), 0, ALWAYS, target=place), **changes
    )


class Shown:
    """Poses shown of one performer, and the points of its feet that stood."""

    def __init__(self, stage: LiveStage, key: str = "one") -> None:
        self.stage, self.key = stage, key
        self.positions: list[np.ndarray] = []
        self.rotations: list[np.ndarray] = []
        self.standing: list[set[int]] = []

    def step(self, count: int = 1, dt: float = STEP) -> None:
        for _ in range(count):
            result = self.stage.step(dt)[self.key]
            self.positions.append(result.positions[0])
            self.rotations.append(result.rotations[0])
            self.standing.append(set(self._standing()))

    def _standing(self):
        result = self.stage.results[self.key]
        for contact in result.composite.contacts:
            if contact.point.is_foot and contact.first <= result.first_frame <= contact.last:
                yield touching_points(contact.point, result.morphology.layout)[0]

    def slide(self, first: int) -> float:
        """Metres that a heel, or a toe at its ball or its tip, moves in a frame, at most, while it stands."""
        ways = np.linalg.norm(np.diff(np.array(self.positions), axis=0), axis=2)
        stands = [
            (frame, point)
            for frame in range(first, len(self.positions))
            for point in self.standing[frame] & self.standing[frame - 1]
        ]
        return max((ways[frame - 1, point : point + 2].min() for frame, point in stands), default=0.0)

    def accelerations(self) -> np.ndarray:
        layout = self.stage.results[self.key].morphology.layout
        rotations, carriers = np.array(self.rotations), np.array(layout.parent_segments())
        local = rotations.copy()
        local[:, 1:] = np.swapaxes(rotations[:, carriers[1:]], 2, 3) @ rotations[:, 1:]
        return angular_acceleration(local, 60.0)


def changed(first: Clip, second: Clip, body: str = "adult_woman", steps: int = 60) -> Shown:
    """``second`` takes over from ``first`` in step ``CHANGE``."""
    stage = LiveStage(staged(first, body=body), prepare)
    shown = Shown(stage)
    shown.step(1, 0.0)
    shown.step(CHANGE - 1)
    stage.start("one", second)
    shown.step(steps)
    return shown


def test_what_nobody_touches_plays_as_the_timeline_has_it():
    project = staged(
        clip_of("walk_turn", 100, 160),
        clip_of("front_kick", 60, 120, 0.9),
        reach=reaching("front_kick", (0.4, 0.0, 1.2)),
    )
    timeline = adapt_performers(
        project, ["one"], prepare, lambda request: adapt(replace(request, eased=False, clears=False))
    )
    stage = LiveStage(
        project.with_entity("performers", "one", replace(project.performers["one"], clears=False)), prepare
    )
    shown = Shown(stage)
    shown.step(1, 0.0)
    shown.step(100)
    whole = timeline.performances["one"].adapted
    np.testing.assert_allclose(np.array(shown.positions), whole.positions[:101], atol=1e-9)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (clip_of("front_kick", 187), clip_of("straight_punch", 164)),
        (clip_of("reach_grasp", 66), clip_of("front_kick", 206)),
        (clip_of("straight_punch", 44), clip_of("front_kick", 64)),
        (clip_of("reach_grasp", 70), clip_of("reach_grasp", 193)),
        (clip_of("walk_turn", 250), clip_of("walk_turn", 107)),
    ],
    ids=lambda clip: f"{clip.motion_id} {clip.first}",
)
@pytest.mark.parametrize("body", ["adult_woman", "child"])
def test_a_clip_takes_over_at_any_frame_without_a_jolt(first, second, body):
    shown = changed(first, second, body)
    peaks = [
        row_motion(staged(replace(each, first=0), body=body), "one", prepare).standing.peak_angular_accelerations
        for each in (first, second)
    ]
    usual = np.maximum(np.maximum(*peaks), QUIET_PEAK)
    assert (shown.accelerations()[CHANGE - 4 :].max(axis=0) / usual).max() < PERMITTED
    ways = np.linalg.norm(np.diff(np.array(shown.positions), axis=0), axis=2).max(axis=1)
    assert ways[CHANGE - 1] < ways[CHANGE - 2] + 0.02


@pytest.mark.parametrize(
    "second", [clip_of("front_kick", 206), clip_of("straight_punch", 164), clip_of("reach_grasp", 94)]
)
@pytest.mark.parametrize("body", ["adult_woman", "child", "giant"])
def test_a_foot_that_stands_does_not_slide_when_a_clip_takes_over(second, body):
    shown = changed(clip_of("reach_grasp", 125), second, body, 40)
    assert any(shown.standing[CHANGE] & shown.standing[CHANGE - 1])
    assert shown.slide(CHANGE) < 1e-3


@pytest.mark.parametrize("step", [0.1, STEP])
@pytest.mark.parametrize("last", [100, 101, 105])
def test_a_row_that_hardly_lasts_stays_where_it_is(last, step):
    """Each time it began as the time before had, ever faster: 72,000 km high after six seconds."""
    stage = LiveStage(staged(clip_of("front_kick", 100, last), body="child"), prepare)
    for _ in range(round(5.0 / step)):
        root = stage.step(step)["one"].positions[0, 0]
        assert np.abs(root).max() < 1.0


def test_a_pose_that_is_held_is_left_from_rest():
    """It was left as fast as the last frames of the clip had been."""
    states = State("walk", clip_of("walk_turn", 60, 110), loop=False), State("stand", clip_of("reach_grasp"))
    ways = (Transition("walk", "stand", (KeyCondition("K"),)),)
    behaviour = Behaviour("B", states, ways, cast=(Role("one"),))
    stage = LiveStage(replace(staged(clip_of("walk_turn", 60)), behaviours={"b": behaviour}), prepare)
    shown = Shown(stage)
    shown.step(90)
    assert np.abs(shown.positions[-1] - shown.positions[-2]).max() < 1e-9
    stage.press("K")
    shown.step(2)
    assert np.abs(shown.positions[-1] - shown.positions[-2]).max() < 0.002


def test_a_row_begins_again_as_long_as_the_stage_plays():
    stage = LiveStage(staged(clip_of("straight_punch", 60, 120), body="child"), prepare)
    for _ in range(120):
        stage.step(0.1)
    assert stage.seconds - stage.playing_clip("one").start < 1.2


def test_a_clip_asked_for_in_every_step_leaves_the_body_where_it_is():
    one, other = clip_of("front_kick", 60), clip_of("straight_punch", 60)
    stage = LiveStage(staged(one, body="child"), prepare)
    for step in range(200):
        stage.start("one", other if step % 2 else one)
        root = stage.step(STEP)["one"].positions[0, 0]
    assert np.abs(root).max() < 1.0


def test_the_same_input_gives_the_same_bits():
    runs = [changed(clip_of("walk_turn", 100), clip_of("front_kick", 60)).positions for _ in range(2)]
    np.testing.assert_array_equal(*runs)


def test_what_ends_goes_over_into_the_first_clip_of_the_row():
    first, second = clip_of("straight_punch", 60, 120), clip_of("front_kick", 60, 120, 1.0)
    stage = LiveStage(staged(first, second), prepare)
    stage.step(0.0)
    assert stage.playing_clip("one") == first
    for _ in range(100):
        stage.step(STEP)
    assert stage.playing_clip("one") == second
    for _ in range(40):
        stage.step(STEP)
    assert stage.playing_clip("one").id == first.id
    assert stage.seconds - stage.playing_clip("one").start < 1.0


def test_a_target_that_is_moved_is_reached_in_the_next_step():
    project = staged(clip_of("straight_punch", 60), reach=reaching("straight_punch", (0.4, -0.2, 1.1)))
    stage = LiveStage(project, prepare)
    for step in range(20):
        place = (0.4, -0.2 + 0.01 * step, 1.1)
        stage.project = project.with_entity("constraints", "reach", reaching("straight_punch", place))
        result = stage.step(STEP if step else 0.0)["one"]
        assert np.linalg.norm(body_point_positions(WRIST, result)[0] - place) < 1e-3


def test_what_was_asked_goes_smoothly_when_another_motion_takes_over():
    stage = LiveStage(staged(clip_of("reach_grasp", 60), reach=reaching("reach_grasp", (0.45, -0.3, 1.3))), prepare)
    shown = Shown(stage)
    shown.step(1, 0.0)
    shown.step(CHANGE - 1)
    stage.start("one", clip_of("straight_punch", 70))
    shown.step(30)
    ways = np.linalg.norm(np.diff(np.array(shown.positions), axis=0), axis=2).max(axis=1)
    assert ways[CHANGE - 1] < 0.02
    assert np.abs(np.diff(ways[CHANGE - 3 :])).max() < 0.02


def test_what_is_asked_in_both_clips_holds_all_the_way():
    place = (0.4, -0.25, 1.25)
    held = reaching("reach_grasp", place, target=FollowProp("box"))
    project = replace(staged(clip_of("reach_grasp", 60), reach=held), props={"box": Prop("Box", position=place)})
    stage = LiveStage(project, prepare)
    for step in range(80):
        if step == CHANGE:
            stage.start("one", clip_of("reach_grasp", 200))
        result = stage.step(STEP if step else 0.0)["one"]
        assert np.linalg.norm(body_point_positions(WRIST, result)[0] - place) < 1e-3


def test_a_ground_that_is_changed_is_stood_on_in_the_next_step():
    project = staged(clip_of("straight_punch", 60))
    stage = LiveStage(project, prepare)
    stage.step(0.0)
    stage.project = project.with_entity(
        "grounds", GROUND_ID, Slope(angle=np.radians(12.0), direction=np.pi / 2, foot=(0.0, -5.0))
    )
    sloped = stage.step(STEP)["one"]
    layout = sloped.morphology.layout
    apart = sloped.positions[0, layout.ankle_point(0)] - sloped.positions[0, layout.ankle_point(1)]
    height = stage.project.ground.height_at(sloped.positions[0, [layout.ankle_point(0), layout.ankle_point(1)], :2])
    assert np.linalg.norm(apart) > 0.2
    assert abs(height[0] - height[1]) > 0.01
    assert abs((height[0] - height[1]) - apart[2]) < 0.03


def test_another_character_goes_on_with_what_plays():
    project = staged(clip_of("front_kick", 60))
    stage = LiveStage(project, prepare)
    for step in range(10):
        stage.step(STEP if step else 0.0)
    stage.project = project.with_entity("performers", "one", replace(project.performers["one"], character_id="giant"))
    assert stage.step(STEP)["one"].morphology == cast()["giant"].morphology
    assert not stage.failures


def two_who_shake_hands() -> Project:
    def follows(who: str, whom: str) -> PositionConstraint:
        return reaching("straight_punch", (0.0, 0.0, 0.0), target=FollowPerformer(whom, WRIST), scope=Scope(who))

    performers = {
        "one": Performer("One", "adult_woman", (clip_of("straight_punch", 60),)),
        "two": Performer("Two", "tall_man", (clip_of("straight_punch", 90),), (0.9, 0.0), np.pi),
    }
    shake = {"one's": follows("one", "two"), "two's": follows("two", "one")}
    return Project(stuff().captures, stuff().motions, cast(), performers, shake, stuff().contacts)


def test_hands_that_follow_each_other_meet_in_every_step():
    project = two_who_shake_hands()
    stage = LiveStage(project, prepare)
    for step in range(60):
        results = stage.step(STEP if step else 0.0)
        hands = [
            Placement.of(project.performers[key]).to_stage(body_point_positions(WRIST, each)[0])
            for key, each in results.items()
        ]
        assert np.linalg.norm(hands[0] - hands[1]) < 2e-3


def test_who_fails_is_told_and_the_others_play_on():
    project = two_who_shake_hands()
    nobody = replace(project.constraints["one's"], target=FollowPerformer("two", WRIST))
    broken = replace(project.captures["front_kick"], body_map=None)
    third = Performer("Three", "child", (clip_of("front_kick"),), (0.0, 2.0))
    project = Project(
        {**project.captures, "front_kick": broken},
        project.motions,
        cast(),
        {**project.performers, "three": third},
        {"x": nobody},
        {},
    )
    stage = LiveStage(project, prepare)
    assert set(stage.step(0.0)) == {"one", "two"}
    assert "three" in stage.failures


@pytest.mark.parametrize("constraints", [("one's",), ("one's", "two's")])
def test_who_follows_somebody_hidden_is_told_so_and_the_others_play_on(constraints):
    project = two_who_shake_hands()
    performers = {**project.performers, "three": replace(project.performers["one"], position=(0.0, 3.0))}
    asked = {key: project.constraints[key] for key in constraints}
    stage = LiveStage(project := replace(project, performers=performers, constraints=asked), prepare)
    stage.step(0.0)
    stage.project = project.with_entity("performers", "two", replace(project.performers["two"], visible=False))
    assert set(stage.step(STEP)) == {"three"}
    assert "follows a character" in stage.failures["one"]


def test_who_comes_or_goes_is_taken_in_while_it_plays():
    project = two_who_shake_hands()
    stage = LiveStage(project, prepare)
    stage.step(0.0)
    alone = project.with_entity("performers", "two", None)
    stage.project = replace(alone, constraints={})
    assert set(stage.step(STEP)) == {"one"}
    stage.project = project
    assert set(stage.step(STEP)) == {"one", "two"}


def test_whose_motion_is_taken_away_plays_its_own_row_again():
    project = staged(clip_of("walk_turn"))
    stage = LiveStage(project, prepare)
    stage.step(0.0)
    stage.start("one", clip_of("front_kick"))
    stage.step(STEP)
    stage.start("one", clip_of("straight_punch"))  # and who has not begun it yet does not
    stage.project = replace(project, motions={"walk_turn": project.motions["walk_turn"]}, contacts={})
    for _ in range(3):
        assert "one" in stage.step(STEP)
        assert [clip.motion_id for clip in stage.staged.performers["one"].clips] == ["walk_turn"]


def of_two(states, transitions, distance: float = 3.0) -> LiveStage:
    performers = {
        "one": Performer("One", "adult_woman", (clip_of("straight_punch", 60),)),
        "two": Performer("Two", "tall_man", (clip_of("straight_punch", 90),), (distance, 0.0), np.pi),
    }
    cast_of = (Role("one", "two"), Role("two", "one"))
    behaviour = Behaviour("Fight", states, transitions, cast=cast_of)
    project = Project(stuff().captures, stuff().motions, cast(), performers, {}, stuff().contacts)
    return LiveStage(replace(project, behaviours={"fight": behaviour}), prepare)


GUARD, KICK, STEP_BACK = (
    State("guard", clip_of("straight_punch", 60, 90)),
    State("kick", clip_of("front_kick", 90, 200), loop=False, event="attack"),
    State("back", clip_of("reach_grasp", 60, 120)),
)


def test_a_key_leads_into_a_state_its_event_reaches_the_partner_and_a_clip_that_ends_leads_back():
    stage = of_two(
        (GUARD, KICK, STEP_BACK),
        (
            Transition("guard", "back", (EventCondition("attack"),)),
            Transition("guard", "kick", (KeyCondition("K"),)),
            Transition("kick", "guard", (ClipEndCondition(),)),
            Transition("back", "guard", (TimeCondition(0.5),)),
        ),
    )
    for step in range(20):
        stage.step(STEP if step else 0.0)
    assert {key: each.state for key, each in stage.running.items()} == {"one": "guard", "two": "guard"}
    stage.press("K")
    stage.step(STEP)
    assert stage.running["one"].state == "kick"
    stage.step(STEP)
    assert stage.playing_clip("one").motion_id == "front_kick"
    states = set()
    for _ in range(170):
        stage.step(STEP)
        states.add(tuple(each.state for each in stage.running.values()))
    assert stage.running["one"].state == "guard"
    assert len(states) > 1


def test_a_distance_leads_into_a_state_and_what_loops_plays_again():
    closer = DistanceCondition(distance=2.0)
    stage = of_two((GUARD, KICK), (Transition("guard", "kick", (closer,)),))
    for step in range(90):
        stage.step(STEP if step else 0.0)
    assert stage.running["one"].state == "guard"
    assert stage.seconds - stage.playing_clip("one").start < 0.6
    near = replace(stage.project.performers["two"], position=(1.0, 0.0))
    stage.project = stage.project.with_entity("performers", "two", near)
    stage.step(STEP)
    stage.step(STEP)
    assert stage.running["one"].state == "kick"


def test_a_clip_of_a_state_that_is_moved_behind_what_plays_is_played_from_there_when_it_comes_again():
    stage = of_two((GUARD,), ())
    for step in range(10):
        stage.step(STEP if step else 0.0)
    fight = stage.project.behaviours["fight"]
    later = replace(GUARD, clip=clip_of("straight_punch", 240, 270))
    stage.project = replace(stage.project, behaviours={"fight": replace(fight, states=(later,))})
    for _ in range(60):
        stage.step(STEP)
    assert (stage.playing_clip("one").first, stage.playing_clip("one").last) == (240, 270)
    assert not stage.failures


def test_a_state_without_a_clip_comes_to_rest():
    stage = of_two((State("still"),), ())
    shown = Shown(stage)
    shown.step(1, 0.0)
    shown.step(90)
    ways = np.linalg.norm(np.diff(np.array(shown.positions), axis=0), axis=2).max(axis=1)
    assert ways[-5:].max() < 1e-6
    assert np.abs(np.diff(ways)).max() < 0.02


def test_what_a_state_asks_is_asked_while_it_lasts():
    meet = Meet(FollowPartner(WRIST), WRIST, chain=Chain(trunk=0.5, root=0.5))
    stage = of_two((replace(GUARD, manners=(meet,)),), (), 0.9)
    for step in range(60):
        results = stage.step(STEP if step else 0.0)
    hands = [
        Placement.of(stage.project.performers[key]).to_stage(body_point_positions(WRIST, each)[0])
        for key, each in results.items()
    ]
    assert np.linalg.norm(hands[0] - hands[1]) < 2e-3


@pytest.mark.parametrize("above", [False, True])
def test_a_correction_acts_live_and_one_that_is_edited_while_it_plays_too(above):
    stage = LiveStage(staged(clip_of("walk_turn", 60)), prepare)
    stage.step(0.0)
    stage.step(0.5)
    plain = stage.results["one"]
    turn = ((BodyPart.LEFT_FOREARM, (0.6, 0.0, 0.0)),)
    made = replace(new_correction("Elbow", "one", 0.5, PoseOffsets(turn)), above=above)
    stage.project = stage.project.with_entity("corrections", "c", made)
    stage.step(0.0)
    posed, wrist = stage.results["one"], plain.morphology.layout.wrist_point(0)
    assert posed.first_frame == plain.first_frame
    assert np.linalg.norm(posed.positions[0, wrist] - plain.positions[0, wrist]) > 0.03
