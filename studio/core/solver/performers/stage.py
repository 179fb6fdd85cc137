"""Performers on one stage: constraints of each, dependencies between them, and tracks of followed targets."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.objections import objection
from studio.core.constraints.target import follows_of, own_place_of, with_own_place
from studio.core.curves.keyed import Keys
from studio.core.mesh.character import Character
from studio.core.normalized.compose import Composite
from studio.core.rotations import multiply, to_matrix
from studio.core.solver.performers.rows import ClipConstraint, timing_of
from studio.core.solver.request import AdaptedMotion, UnconstrainedPoses
from studio.core.solver.task_assembly.tracks import OwnPath, Track, Tracks
from studio.core.solver.task_assembly.whole_body import areas_of
from studio.core.stage.held_grips import repeats_as_held
from studio.core.stage.mirrored_props import with_held_props_reflected
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import InHand, Prop
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Followed:
    """A followed target, and how to compute its track. Equal objects have equal tracks."""

    follow: Follow
    depends_on: tuple[Any, ...]
    """All values that determine the track."""
    make: Callable[[Composite], Track | OwnPath] = field(compare=False)
    """Computes the track for the frames of a composite motion."""


def constraints_of_performer(project: Project, performer_id: str) -> tuple[ClipConstraint, ...]:
    """Constraints of a performer in each of its clips, highest priority first.

    A constraint on the performer itself is left out, unless it belongs to this performer alone: then it follows a point
    of the same body. Constraints on performers without clips are left out. Per-character offsets are resolved.
    """
    known = project.known.get((constraints_of_performer, performer_id))
    if known is None:
        known = project.known[constraints_of_performer, performer_id] = _asked_of(project, performer_id)
    return cast(tuple[ClipConstraint, ...], known)


def _asked_of(project: Project, performer_id: str) -> tuple[ClipConstraint, ...]:
    """Constraints of ``constraints_of_performer``, computed without its cache."""
    performer, playing = project.performers[performer_id], _playing(project)
    asked = [
        ClipConstraint(key, with_held_props_reflected(project, performer_id, clip, held, repeat), index, repeat)
        for index, clip in enumerate(performer.clips)
        for key, constraint in project.constraints_for(performer_id, clip).items()
        if constraint.enabled
        and (
            concerned := constraint_for_performer(
                constraint, performer_id, playing, project.props, mirrored=clip.mirrored
            )
        )
        is not None
        for part in _parts_of(concerned, project.characters[performer.character_id])
        for repeat, held in enumerate(repeats_as_held(project, performer_id, clip, part))
        if held is not None
    ]
    return tuple(sorted(asked, key=lambda each: each.constraint.priority))


def _parts_of(constraint: Constraint, character: Character) -> tuple[Constraint, ...]:
    """The constraint itself, or for an area that a whole body keeps out of, one for each of the body's points."""
    if not (isinstance(constraint, AreaConstraint) and constraint.whole):
        return (constraint,)
    return areas_of(constraint, character.morphology, character.volume)


def _playing(project: Project) -> Collection[str]:
    """Ids of the performers with clips, cached."""
    known = project.known.get(_playing)
    if known is None:
        known = project.known[_playing] = {key for key, each in project.performers.items() if each.clips}
    return cast(Collection[str], known)


def leaders_of(project: Project, performer_id: str) -> set[str]:
    """Ids of the other performers that a performer follows, directly or by the props that they hold."""
    known = project.known.get((leaders_of, performer_id))
    if known is None:
        follows = (
            follow for each in constraints_of_performer(project, performer_id) for follow in follows_of(each.constraint)
        )
        leaders = {follow.performer_id for follow in follows if isinstance(follow, FollowPerformer)}
        holders = frozenset[str]().union(*(each.holders for each in props_of(project, performer_id)))
        playing = {key for key in holders if project.performers[key].clips}
        known = project.known[leaders_of, performer_id] = (leaders | playing) - {performer_id}
    return cast(set[str], known)


def props_of(project: Project, performer_id: str) -> tuple[Prop, ...]:
    """Props that a performer follows."""
    follows = (
        follow for each in constraints_of_performer(project, performer_id) for follow in follows_of(each.constraint)
    )
    found = dict.fromkeys(follow.prop_id for follow in follows if isinstance(follow, FollowProp))
    return tuple(project.props[key] for key in found)


def leaders_first(project: Project, performer_ids: Iterable[str]) -> tuple[tuple[str, ...], ...]:
    """Dependency cycles of the given performers and all that they follow, in order of dependency.

    Leaders come before their followers; a performer outside of any cycle is a cycle of one.
    """
    leaders: dict[str, set[str]] = {}
    waiting = list(performer_ids)
    while waiting:
        key = waiting.pop()
        if key not in leaders:
            leaders[key] = leaders_of(project, key)
            waiting += leaders[key]
    keys = [key for key in project.performers if key in leaders]
    circles = _dependency_cycles(keys, leaders)
    ordered: dict[tuple[str, ...], None] = {}

    def put(circle: tuple[str, ...]) -> None:
        if circle not in ordered:
            for leader in sorted({leader for key in circle for leader in leaders[key]} - set(circle)):
                put(circles[leader])
            ordered[circle] = None

    for key in keys:
        put(circles[key])
    return tuple(ordered)


def _dependency_cycles(keys: list[str], leaders: dict[str, set[str]]) -> dict[str, tuple[str, ...]]:
    """Dependency cycle of each performer, mostly the performer alone, by performer id."""
    if not any(leaders.values()):
        return {key: (key,) for key in keys}

    from scipy.sparse import coo_array  # late: it takes longer than a window
    from scipy.sparse.csgraph import connected_components

    row = {key: index for index, key in enumerate(keys)}
    edges = np.array([(row[key], row[leader]) for key in keys for leader in leaders[key]], dtype=np.int64).reshape(
        -1, 2
    )
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(len(keys), len(keys)))
    _, labels = connected_components(graph, directed=True, connection="strong")
    return {key: tuple(other for other in keys if labels[row[other]] == labels[row[key]]) for key in keys}


def tracks_followed_by(
    project: Project,
    performer_id: str,
    result_of: Callable[[str], AdaptedMotion | None],
    circle: Collection[str] = (),
    constraints: Iterable[Constraint] | None = None,
    own: AdaptedMotion | None = None,
) -> tuple[Followed, ...] | None:
    """Followed targets of a performer outside its own body; None while a leader's result is missing.

    Other members of its dependency cycle ``circle``, and props that they hold, are left out, because they are solved
    together. For ``constraints``, or by default for all of the performer. A prop in its own hands follows its grounded
    motion, or ``own`` if that is given.
    """
    performer, others = project.performers[performer_id], {*circle} - {performer_id}
    found: dict[Follow, Followed] = {}
    leaders = leaders_of(project, performer_id)
    asked = (
        [each.constraint for each in constraints_of_performer(project, performer_id)]
        if constraints is None
        else constraints
    )
    for follow in (follow for each in asked for follow in follows_of(each)):
        match follow:
            case FollowProp() if not project.props[follow.prop_id].holders & others:
                holders = project.props[follow.prop_id].holders & leaders
                results = {key: result for key in holders if (result := result_of(key)) is not None}
                if len(results) < len(holders):
                    return None
                if own is not None and performer_id in project.props[follow.prop_id].holders:
                    results[performer_id] = own
                found[follow] = _prop(follow, project, performer_id, results)
            case FollowTracked():
                found[follow] = _tracked(follow, project, performer)
            case FollowPerformer() if follow.performer_id not in circle:
                result = result_of(follow.performer_id)
                if result is None:
                    return None
                found[follow] = _performer(follow, project, performer, result)
    return tuple(found.values())


def tracks_of(followed: Iterable[Followed], composite: Composite) -> Tracks:
    """Tracks of followed targets in the frames of a composite motion; may take seconds."""
    return {each.follow: each.make(composite) for each in followed}


def _prop(follow: FollowProp, project: Project, performer_id: str, results: Mapping[str, AdaptedMotion]) -> Followed:
    """Followed prop of one performer; ``results`` are the motions of the prop's holders, by performer id."""
    prop, own = project.props[follow.prop_id], Placement.of(project.performers[performer_id])
    leaders = {key: project.performers[key] for key in results}
    timings = {key: _timing_in(project, leaders[key], result) for key, result in results.items()}

    def make(composite: Composite) -> Track | OwnPath:
        from studio.core.solver.performers.prop_tracks import (  # here: it loads kernels
            Hands,
            Holder,
            own_hands,
            stage_track,
            track_in_motion_space,
        )

        seconds = _seconds_of(composite)
        hands: dict[str, Hands] = {}
        for key, result in results.items():
            rows = timings[key].frames_at(seconds) - result.first_frame
            hands[key] = Holder(result, rows, Placement.of(leaders[key]), timing=timings[key])

        def among(unasked: UnconstrainedPoses, body: AnyMorphology) -> Track:
            mine = own_hands(unasked, body, composite.timing, own)
            return track_in_motion_space(follow, prop, stage_track(prop, seconds, {**hands, performer_id: mine}), own)

        if performer_id in prop.holders - hands.keys():
            return OwnPath(among)
        return track_in_motion_space(follow, prop, stage_track(prop, seconds, hands), own)

    is_keyed = isinstance(prop.heading, Keys) or isinstance(prop.tilt, Keys)
    moving = prop.holds or not isinstance(prop.position, tuple) or is_keyed
    depends = (*results.values(), *timings.values(), project.performers[performer_id].clips) if moving else ()
    return Followed(follow, (prop, own, *map(Placement.of, leaders.values()), *depends), make)


def _tracked(follow: FollowTracked, project: Project, performer: Performer) -> Followed:
    """Followed captured joint of one performer."""
    captures = tuple(project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.clips)
    leg = project.characters[performer.character_id].morphology.leg_length

    def make(composite: Composite) -> Track:
        from studio.core.solver.performers.followed_tracks import tracked_in_row

        return tracked_in_row(follow, captures, composite, leg)

    return Followed(follow, (*map(id, captures), performer.clips, leg), make)


def _performer(follow: FollowPerformer, project: Project, performer: Performer, result: AdaptedMotion) -> Followed:
    """Followed point of another performer, with the motion ``result``."""
    leader = project.performers[follow.performer_id]
    timing, places = _timing_in(project, leader, result), (Placement.of(leader), Placement.of(performer))

    def make(composite: Composite) -> Track:
        return leader_track(follow, result, timing, _seconds_of(composite), *places)

    return Followed(follow, (result, timing, performer.clips, places), make)


def _timing_in(project: Project, leader: Performer, result: AdaptedMotion) -> Timing:
    """Timing of the frames of a leader's motion."""
    return timing_of(project, leader) if result.composite is None else result.composite.timing


def _seconds_of(composite: Composite) -> FloatArray:
    """Seconds (F,) of the stage at the frames of a composite motion."""
    return composite.timing.begin + np.arange(composite.motion.frame_count) / composite.timing.frame_rate


def leader_track(
    follow: FollowPerformer,
    result: AdaptedMotion,
    timing: Timing,
    seconds: FloatArray,
    placement: Placement,
    own: Placement,
) -> Track:
    """Track of another performer's point at ``seconds`` (F,) of the stage, in the space of a performer at ``own``.

    ``result`` is the other performer's motion, with its ``timing`` and ``placement``.
    """
    from studio.core.solver.performers.followed_tracks import performer_track

    rows = timing.frames_at(seconds) - result.first_frame
    return performer_track(follow.point, follow.turn, result, rows, placement, own)


def constraint_for_performer(
    constraint: Constraint,
    performer_id: str,
    playing: Collection[str],
    props: Mapping[str, Prop],
    *,
    mirrored: bool = False,
) -> Constraint | None:
    """Constraint as it applies to one performer among those ``playing``; None if it does not apply.

    The rules are those of ``constraints_of_performer``. A prop that is always in the performer's own hand becomes a
    point of that hand, or of the other hand for a clip that will be ``mirrored``.
    """
    changes: dict[str, Any] = {}
    for name, value in vars(constraint).items():
        if (own := own_place_of(value)) is not None and own.own:
            changes[name] = with_own_place(value, own.of(performer_id))
        if isinstance(value, FollowProp):
            prop = props[value.prop_id]
            if isinstance(prop.held, InHand) and prop.held.is_always and prop.held.performer_id == performer_id:
                changes[name] = point_in_own_hand(value, prop, prop.held.mirrored() if mirrored else prop.held)
                if changes[name].point == constraint.point or objection(replace(constraint, **changes), ()):
                    return None
        if not isinstance(value, FollowPerformer):
            continue
        if value.performer_id not in playing:
            return None
        if value.performer_id == performer_id:
            if not constraint.scope.is_narrow or _is_at_itself(constraint, value):
                return None
            changes[name] = FollowBody(value.point, value.turn)
    return replace(constraint, **changes) if changes else constraint


def point_in_own_hand(follow: FollowProp, prop: Prop, held: InHand) -> FollowBody:
    """Followed point of a prop that is held in the own hand, as a point of the body."""
    offset = np.array(follow.offset)
    if follow.along_arms:
        offset = to_matrix(np.array(follow.turn)) @ offset
    displacement = offset + np.array(follow.share) * np.array(prop.size) / 2
    x, y, z = (np.array(held.point.offset) + to_matrix(np.array(held.turn)) @ displacement).tolist()
    qx, qy, qz, qw = multiply(np.array(held.turn), np.array(follow.turn)).tolist()
    return FollowBody(replace(held.point, offset=(x, y, z)), (qx, qy, qz, qw))


def _is_at_itself(constraint: Constraint, follow: FollowPerformer) -> bool:
    """True if a constraint on the own body follows its own point or segment."""
    if constraint.kind == "orientation":
        return follow.point.part == constraint.point.part
    return follow.point == constraint.point
