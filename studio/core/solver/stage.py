"""Performers on one stage: what each is asked, whom it follows, and where that is at each of its frames."""

from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.target import follows_of
from studio.core.placement import Placement
from studio.core.project import Clip, Project
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.tracks import Track, Tracks

NEVER = ActivationCurve(-1.0, -1.0, -1.0, -1.0)
"""Before every motion."""


@dataclass(frozen=True)
class Followed:
    """What a constraint follows: equal ones have equal tracks, and ``make`` computes them."""

    follow: Follow
    depends_on: tuple[Any, ...]
    make: Callable[[], Track] = field(compare=False)


def asked_of(project: Project, performer_id: str) -> tuple[Constraint, ...]:
    """The constraints on a performer that are on, highest priority first, as they concern that performer.

    One that follows the performer itself follows a point of the same body; where that is the very point, or who is
    followed plays nothing, nothing is asked. A place that is each body's own has this one's offset.
    """
    clips = project.performers[performer_id].clips
    constraints = project.constraints_of(clips[0].motion_id).values() if clips else ()
    playing = {key for key, performer in project.performers.items() if performer.clips}
    return tuple(concerning(each, performer_id, playing) for each in constraints if each.enabled)


def leaders_of(project: Project, performer_id: str) -> set[str]:
    """The other performers that a performer follows."""
    follows = (follow for each in asked_of(project, performer_id) for follow in follows_of(each))
    return {follow.performer_id for follow in follows if isinstance(follow, FollowPerformer)}


def is_led_by(project: Project, performer_id: str, leader_id: str) -> bool:
    """Whether ``performer_id`` follows ``leader_id``, or one who does."""
    known: set[str] = set()
    waiting = leaders_of(project, performer_id)
    while waiting:
        if leader_id in waiting:
            return True
        known |= waiting
        waiting = {each for leader in waiting for each in leaders_of(project, leader)} - known
    return False


def with_leaders(project: Project, performer_ids: Iterable[str]) -> tuple[str, ...]:
    """These performers and all whom they follow, leaders first; in a circle anyone is."""
    ordered: dict[str, None] = {}
    begun: set[str] = set()

    def put(key: str) -> None:
        if key not in begun:
            begun.add(key)
            for leader in sorted(leaders_of(project, key)):
                put(leader)
            ordered[key] = None

    for key in performer_ids:
        put(key)
    return tuple(ordered)


def followed_by(
    project: Project,
    performer_id: str,
    result_of: Callable[[str], AdaptedMotion | None],
    standing_of: Callable[[str], AdaptedMotion],
) -> tuple[Followed, ...] | None:
    """All that a performer follows beyond its own body; None while the result of someone it follows is not there.

    Performers who follow each other in a circle follow each other's ``standing_of``: as they would move without any
    constraint. That is asked for only when a track is made.
    """
    own = Placement.of(project.performers[performer_id])
    found: dict[Follow, Followed] = {}
    for follow in (follow for each in asked_of(project, performer_id) for follow in follows_of(each)):
        match follow:
            case FollowProp():
                found[follow] = _prop(follow, project, own)
            case FollowTracked():
                found[follow] = _tracked(follow, project, performer_id)
            case FollowPerformer():
                leader = follow.performer_id
                circle = is_led_by(project, leader, performer_id)
                result = None if circle else result_of(leader)
                if result is None and not circle:
                    return None
                found[follow] = _performer(follow, project, performer_id, result, standing_of)
    return tuple(found.values())


def tracks_of(followed: Iterable[Followed]) -> Tracks:
    """The tracks themselves: what may take a while."""
    return {each.follow: each.make() for each in followed}


def _prop(follow: FollowProp, project: Project, own: Placement) -> Followed:
    prop = project.props[follow.prop_id]

    def make() -> Track:
        from studio.core.solver.following import prop_track  # here and below: it loads kernels

        return prop_track(follow, prop, own)

    return Followed(follow, (prop, own), make)


def _tracked(follow: FollowTracked, project: Project, performer_id: str) -> Followed:
    motion_id = project.performers[performer_id].clips[0].motion_id
    capture = project.captures[project.motions[motion_id].capture_id]

    def make() -> Track:
        from studio.core.solver.following import tracked_track

        return tracked_track(follow, capture)

    return Followed(follow, (id(capture),), make)


def _performer(
    follow: FollowPerformer,
    project: Project,
    performer_id: str,
    result: AdaptedMotion | None,
    standing_of: Callable[[str], AdaptedMotion],
) -> Followed:
    performer, leader = project.performers[performer_id], project.performers[follow.performer_id]
    capture = project.captures[project.motions[performer.clips[0].motion_id].capture_id]
    clips, places = (performer.clips[0], leader.clips[0]), (Placement.of(performer), Placement.of(leader))

    def make() -> Track:
        from studio.core.solver.following import performer_track

        motion = standing_of(follow.performer_id) if result is None else result
        frames = np.arange(capture.frame_count)
        rows = leader_frames(frames, capture.frame_rate, *clips, motion.frame_rate) - motion.first_frame
        return performer_track(follow.point, follow.turn, motion, rows, places[1], places[0])

    if result is not None:
        return Followed(follow, (result, clips, places), make)
    build, ground = project.characters[leader.character_id].morphology, project.ground
    contacts = tuple(project.contacts_of(leader.clips[0].motion_id).values())
    return Followed(follow, (build, ground, contacts, clips, places), make)


def leader_frames(
    frames: np.ndarray[Any, Any], frame_rate: float, clip: Clip, leader: Clip, leader_rate: float
) -> np.ndarray[Any, Any]:
    """(F,) the leader's frame, not rounded, that plays when each of ``frames`` does; held at its clip's ends."""
    stage = clip.start + (frames - clip.first) / frame_rate
    return np.clip(leader.first + (stage - leader.start) * leader_rate, leader.first, leader.last)


def concerning(constraint: Constraint, performer_id: str, playing: Container[str]) -> Constraint:
    """A constraint as one performer has it, of those that are ``playing``; see ``asked_of``."""
    changes: dict[str, Any] = {}
    for name in (each.name for each in fields(constraint)):
        value = getattr(constraint, name)
        if isinstance(value, OwnPlace):
            changes[name] = value.of(performer_id)
        if not isinstance(value, FollowPerformer):
            continue
        same = value.point.part == constraint.point.part if constraint.kind == "orientation" else (
            value.point == constraint.point
        )  # fmt: skip
        if value.performer_id not in playing or (value.performer_id == performer_id and same):
            changes |= {name: _nowhere(constraint), "activation": NEVER}
        elif value.performer_id == performer_id:
            changes[name] = FollowBody(value.point, value.turn)
    return replace(constraint, **changes) if changes else constraint


def _nowhere(constraint: Constraint) -> tuple[float, ...]:
    return (0.0, 0.0, 0.0, 1.0) if constraint.kind == "orientation" else (0.0, 0.0, 0.0)
