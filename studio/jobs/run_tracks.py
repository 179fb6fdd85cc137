"""Tracks that the characters of one run follow: props of the constraint file, joints of the capture, other
characters.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from studio.core.captures.capture import Capture
from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.dependency_cycles import CycleMember, solve_cycle
from studio.core.solver.performers.followed_tracks import captured_joint_track
from studio.core.solver.performers.prop_tracks import stage_track, track_in_motion_space
from studio.core.solver.performers.stage import constraint_for_performer
from studio.core.solver.request import AdaptRequest
from studio.core.solver.task_assembly.tracks import Track
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop


def with_tracks(
    requests: Mapping[str, AdaptRequest], capture: Capture, props: Mapping[str, Prop], places: Mapping[str, Placement]
) -> dict[str, AdaptRequest]:
    """Requests by character, with the tracks that their constraints follow; ``places`` are the characters' placements.

    Characters that follow others are solved together with them, as on a stage, until no followed point moves. Raises
    StudioError, which names the constraint, if a followed character or object is missing.
    """
    constraints = next(iter(requests.values())).constraints if requests else ()
    for each in constraints:
        if each.scope.clip_id or each.scope.performer_id not in ("", *requests):
            asked_alone = each.scope.performer_id or f"clip {each.scope.clip_id}"
            raise StudioError(
                f"'{each.name}' applies to '{asked_alone}', which is not among the characters: {', '.join(requests)}."
            )
    _check_followed(constraints, requests)
    asked = {}
    for key, request in requests.items():
        concerning_it = tuple(_concerning(key, constraints, requests, props))
        asked[key] = _with_own_tracks(replace(request, constraints=concerning_it), capture, props, places[key])
    leads = {key: _leaders(request) for key, request in asked.items()}
    followed = set().union(*leads.values())
    players = {
        key: CycleMember(request, _played(request), places[key], props)
        for key, request in asked.items()
        if leads[key] or key in followed
    }
    return asked | dict(solve_cycle(players, lambda _, request: adapt(request)).requests)


def _played(request: AdaptRequest) -> Composite:
    """Composite of one piece: all frames of the request's motion, beginning at 0 s."""
    return compose_pieces((MotionPiece(request.motion, request.contacts, 0, request.motion.frame_count - 1),))


def _concerning(
    key: str, constraints: tuple[Constraint, ...], requests: Mapping[str, AdaptRequest], props: Mapping[str, Prop]
) -> Iterator[Constraint]:
    """Constraints of the file that apply to the character ``key``: those of all characters and those of
    this one alone.
    """
    for each in constraints:
        concerned = constraint_for_performer(each, key, requests, props) if each.scope.includes(key, "") else None
        if concerned is not None:
            yield concerned


def _leaders(request: AdaptRequest) -> set[str]:
    """Ids of the characters that the constraints of a request follow."""
    follows = (follow for constraint in request.constraints for follow in follows_of(constraint))
    return {follow.performer_id for follow in follows if isinstance(follow, FollowPerformer)}


def _check_followed(constraints: tuple[Constraint, ...], requests: Mapping[str, AdaptRequest]) -> None:
    for constraint in constraints:
        for follow in follows_of(constraint):
            if isinstance(follow, FollowPerformer) and follow.performer_id not in requests:
                raise StudioError(
                    f"'{constraint.name}' follows '{follow.performer_id}', which is not among the characters:"
                    f" {', '.join(requests)}."
                )


def _with_own_tracks(
    request: AdaptRequest, capture: Capture, props: Mapping[str, Prop], placement: Placement
) -> AdaptRequest:
    """Request with the tracks of props and captured joints."""
    tracks: dict[Follow | OwnPlace | Support, Track] = {}
    for constraint in request.constraints:
        for follow in follows_of(constraint):
            match follow:
                case FollowProp():
                    prop = props[follow.prop_id]
                    tracks[follow] = track_in_motion_space(
                        follow, prop, stage_track(prop, request.motion.times), placement
                    )
                case FollowTracked():
                    try:
                        tracks[follow] = captured_joint_track(follow, capture)
                    except StudioError as error:
                        raise StudioError(f"'{constraint.name}' follows a joint that is not there. {error}") from error
    return replace(request, tracks=tracks)
