"""Performers and props that are followed: leaders first, circles together, everybody kept up to date."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.stage import constraints_of_performer, leaders_first, leaders_of
from studio.core.stage.placement import Placement
from studio.core.stage.project import Motion, Project
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.engine.live_adaptation import LiveAdaptation, normalized_with_actor
from studio.engine.posed_performer import posed_performers
from studio.viewport.handles import constraint_handles
from tests.builders import make_constraint, make_project
from tests.core.motions import ALWAYS
from tests.patience import SECONDS

LEFT, RIGHT = (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True) for side in ("left", "right"))
REACH = Chain(trunk=0.5, root=1.0)


def stage(characters: int = 2, **followed: str) -> Project:
    """Bodies a hand's breadth apart, each playing a motion of its own, frame by frame.

    ``p0="p1"``: p0's right wrist follows p1's.
    """
    project = make_project(characters=characters, constraints=0, contacts=0)
    project = project.with_entity("motions", "motion", None)
    for k in range(characters):
        motion = f"m{k}"
        performer = project.performers[f"performer {k}"]
        clips = (replace(performer.clips[0], motion_id=motion),)
        performer = replace(performer, clips=clips, position=(0.0, 0.25 * k), heading=0.2 * k, eased=False)
        project = project.with_entity("motions", motion, Motion(motion, "capture"))
        project = project.with_entity("performers", f"performer {k}", None).with_entity(
            "performers", f"p{k}", performer
        )
    for follower, leader in followed.items():
        target = FollowPerformer(leader, RIGHT)
        asked = make_constraint(f"m{follower[1]}", follower, target=target, chain=REACH, activation=ALWAYS)
        project = project.with_entity("constraints", follower, asked)
    return project


@pytest.fixture
def live_of(qapp: Any):
    made = []

    def make(project: Project) -> tuple[Document, LiveAdaptation]:
        document = Document(project)
        live = LiveAdaptation(document)
        made.append(live)
        assert live.wait_until_solved(SECONDS)
        return document, live

    yield make
    for live in made:
        live.close()


def on_stage(document: Document, live: LiveAdaptation, performer_id: str, point: BodyPoint = RIGHT) -> np.ndarray:
    result = live.result(performer_id)
    assert result is not None
    return Placement.of(document.project.performers[performer_id]).to_stage(body_point_positions(point, result))


def seen(document: Document, live: LiveAdaptation, performer_id: str) -> np.ndarray:
    """Place at which the wrist of a performer is seen, on the stage."""
    shown = live.shown_frame(performer_id)
    assert shown is not None
    return Placement.of(document.project.performers[performer_id]).to_stage(body_point_positions(RIGHT, shown))[0]


def test_who_follows_whom_is_told_from_the_constraints_of_the_motion_that_is_played() -> None:
    project = stage(4, p0="p1", p1="p2", p3="p0")
    assert leaders_of(project, "p0") == {"p1"}
    assert leaders_first(project, ["p3", "p0"]) == (("p2",), ("p1",), ("p0",), ("p3",))


def test_nobody_follows_itself_unless_that_is_asked_of_it_alone() -> None:
    project = stage(2, p0="p0")
    assert constraints_of_performer(project, "p0") == ()
    other = replace(project.constraints["p0"], point=LEFT)
    assert constraints_of_performer(project.with_entity("constraints", "p0", other), "p0") == ()
    alone = replace(other, scope=Scope(performer_id="p0"))
    [asked] = constraints_of_performer(project.with_entity("constraints", "p0", alone), "p0")
    assert isinstance(asked.constraint, PositionConstraint)
    assert asked.constraint.target == FollowBody(RIGHT)
    assert leaders_of(project, "p0") == set()


def test_who_follow_each_other_are_adapted_together() -> None:
    project = stage(4, p0="p1", p1="p2", p2="p0", p3="p1")
    assert leaders_first(project, ["p3"]) == (("p0", "p1", "p2"), ("p3",))


def test_a_wrist_follows_another_performers_wrist_and_again_when_that_one_is_changed(live_of: Any) -> None:
    document, live = live_of(stage(2, p0="p1"))
    assert on_stage(document, live, "p0") == pytest.approx(on_stage(document, live, "p1"), abs=3e-4)
    lead = make_constraint("m1", "Lead", target=(0.3, -0.2, 1.1), chain=REACH, activation=ALWAYS)
    document.add("constraints", lead, "Add")
    assert live.wait_until_solved(SECONDS)
    assert body_point_positions(RIGHT, live.result("p1"))[0] == pytest.approx((0.3, -0.2, 1.1), abs=3e-4)
    near_limit = pytest.approx(on_stage(document, live, "p1"), abs=1e-3)  # where a shoulder ends
    assert on_stage(document, live, "p0") == near_limit


def test_a_hidden_performer_is_followed_too(live_of: Any) -> None:
    project = stage(2, p0="p1")
    hidden = replace(project.performers["p1"], visible=False)
    document, live = live_of(project.with_entity("performers", "p1", hidden))
    assert on_stage(document, live, "p0") == pytest.approx(on_stage(document, live, "p1"), abs=3e-4)


def test_two_whose_wrists_follow_each_other_meet_between_them(live_of: Any) -> None:
    document, live = live_of(stage(2))
    free = {key: on_stage(document, live, key) for key in ("p0", "p1")}
    document, live = live_of(stage(2, p0="p1", p1="p0"))
    there = {key: on_stage(document, live, key) for key in ("p0", "p1")}
    assert np.linalg.norm(there["p0"] - there["p1"], axis=1).max() < 1e-3
    assert there["p0"] == pytest.approx((free["p0"] + free["p1"]) / 2, abs=2e-3)


def test_a_wrist_follows_a_prop_that_is_moved_and_goes_with_it_when_it_is_removed(live_of: Any) -> None:
    project = stage(1)
    document, live = live_of(project.with_entity("props", "box", Prop("Box", position=(0.3, -0.2, 1.0))))
    follow = FollowProp("box", (0.0, 0.0, 0.1))
    document.add("constraints", make_constraint("m0", target=follow, chain=REACH, activation=ALWAYS), "Add")
    assert live.wait_until_solved(SECONDS)
    assert on_stage(document, live, "p0")[5] == pytest.approx((0.3, -0.2, 1.1), abs=3e-4)
    moved = replace(document.project.props["box"], position=(0.2, -0.3, 0.9))
    document.replace("props", "box", moved, "Move Box")
    assert live.wait_until_solved(SECONDS)
    assert on_stage(document, live, "p0")[5] == pytest.approx((0.2, -0.3, 1.0), abs=3e-4)
    document.remove("props", "box", "Delete Box")
    assert not document.project.constraints
    document.undo_stack.undo()
    assert len(document.project.constraints) == 1


def test_a_wrist_follows_a_joint_of_its_capture(live_of: Any) -> None:
    document, live = live_of(stage(1))
    source = live.source("m0")
    assert live.wait_until_solved(SECONDS)
    source = live.source("m0")
    asked = make_constraint("m0", target=FollowTracked("RightHand"), chain=REACH, activation=ALWAYS)
    document.add("constraints", asked, "Add")
    assert live.wait_until_solved(SECONDS)
    wrist = body_point_positions(RIGHT, source)
    assert body_point_positions(RIGHT, live.result("p0")) == pytest.approx(wrist, abs=5e-4)


def test_who_follows_a_performer_that_is_driven_live_follows_what_it_does_now_and_its_clips_again_afterwards(
    live_of: Any,
) -> None:
    document, live = live_of(stage(3, p0="p1", p2="p0"))
    source = stage(1).captures["capture"]
    motion, _ = normalized_with_actor(source)
    before = {key: live.shown_frame(key) for key in ("p0", "p2")}
    for frame in (3, 12):
        pose = replace(motion, channels=np.stack([motion.channels[frame]] * 2))
        live.driven.drive("p1", lambda pose=pose: pose)
        live.solve_frame(0.0)
        there = {key: seen(document, live, key) for key in ("p0", "p1", "p2")}
        for follower in ("p0", "p2"):
            assert there[follower] == pytest.approx(there["p1"], abs=1e-3)
        assert np.linalg.norm(there["p1"] - on_stage(document, live, "p1")[0]) > 0.01
    live.driven.drive("p1", None)
    live.solve_frame(0.0)
    assert {key: live.shown_frame(key) for key in before} == before


def test_the_figure_of_a_constraint_in_a_clip_that_continues_another_leads_from_the_point_of_the_body(
    live_of: Any,
) -> None:
    project = make_project(characters=1, constraints=1, contacts=0)
    performer = project.performers["performer 0"]
    first = replace(performer.clips[0], first=0, last=12, start=0.0)
    turned = replace(first, start=first.length(30.0), joined=True, turn=1.2, offset=(0.8, -0.3))
    performer = replace(performer, clips=(first, turned), heading=0.4)
    project = project.with_entity("performers", "performer 0", performer)
    always = replace(project.constraints["constraint 0"], activation=ALWAYS)
    document, live = live_of(project.with_entity("constraints", "constraint 0", always))
    posed = posed_performers(document.project, live.result, turned.start + 0.2)
    [handle] = constraint_handles(document.project, posed, "performer 0")
    pose = posed["performer 0"]
    wrist = pose.placement.to_stage(body_point_positions(always.point, pose.motion)[pose.row])
    assert handle.figure.link is not None
    assert handle.figure.link[0] == pytest.approx(wrist, abs=1e-6)
    assert handle.figure.link[1] == pytest.approx(handle.target, abs=1e-6)
