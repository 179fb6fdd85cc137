"""What the characters of one run follow: props of the constraint file, joints of the capture, each other."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from studio.core.captures.capture import Capture
from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.solver.adapt import adapt
from studio.core.solver.asking.tracks import Track
from studio.core.solver.performers.following import performer_track, tracked_track
from studio.core.solver.performers.props import seen_from, stage_track
from studio.core.solver.performers.stage import concerning
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop


def with_tracks(
    requests: Mapping[str, AdaptRequest], capture: Capture, props: Mapping[str, Prop], places: Mapping[str, Placement]
) -> dict[str, AdaptRequest]:
    """The requests, by character, with the tracks of what their constraints follow; ``places`` say where each stands.

    Of several characters that are followed each follows how the others move without constraints. Raises StudioError
    naming the constraint where somebody or something followed is not there.
    """
    constraints = next(iter(requests.values())).constraints if requests else ()
    for each in constraints:
        if each.scope.clip_id or each.scope.performer_id not in ("", *requests):
            asked_alone = each.scope.performer_id or f"clip {each.scope.clip_id}"
            raise StudioError(
                f"'{each.name}' is asked of '{asked_alone}', which is not among the characters: {', '.join(requests)}."
            )
    leaders = _leaders(constraints, requests)
    asked = {
        key: replace(request, constraints=tuple(_concerning(key, constraints, requests, props)))
        for key, request in requests.items()
    }
    bare = {key: adapt(replace(asked[key], constraints=())) for key in leaders} if len(leaders) > 1 else {}
    led = {key: _following(key, asked[key], bare, capture, props, places) for key in leaders}
    motions = {key: adapt(request) for key, request in led.items()}
    return {
        key: led[key] if key in led else _following(key, asked[key], motions, capture, props, places) for key in asked
    }


def _concerning(
    key: str, constraints: tuple[Constraint, ...], requests: Mapping[str, AdaptRequest], props: Mapping[str, Prop]
) -> Iterator[Constraint]:
    """What of the file is asked of one character: of all, or of it alone."""
    for each in constraints:
        concerned = concerning(each, key, requests, props) if each.scope.includes(key, "") else None
        if concerned is not None:
            yield concerned


def _leaders(constraints: tuple[Constraint, ...], requests: Mapping[str, AdaptRequest]) -> list[str]:
    leaders: dict[str, None] = {}
    for constraint in constraints:
        for follow in follows_of(constraint):
            if isinstance(follow, FollowPerformer):
                if follow.performer_id not in requests:
                    raise StudioError(
                        f"'{constraint.name}' follows '{follow.performer_id}', who is not among the characters:"
                        f" {', '.join(requests)}."
                    )
                leaders[follow.performer_id] = None
    return list(leaders)


def _following(
    key: str,
    request: AdaptRequest,
    motions: Mapping[str, AdaptedMotion],
    capture: Capture,
    props: Mapping[str, Prop],
    places: Mapping[str, Placement],
) -> AdaptRequest:
    tracks: dict[Follow | OwnPlace | Support, Track] = {}
    for constraint in request.constraints:
        for follow in follows_of(constraint):
            match follow:
                case FollowPerformer():
                    motion, there = motions[follow.performer_id], places[follow.performer_id]
                    rows = range(motion.frame_count)
                    tracks[follow] = performer_track(follow.point, follow.turn, motion, rows, there, places[key])
                case FollowProp():
                    prop = props[follow.prop_id]
                    tracks[follow] = seen_from(follow, prop, stage_track(prop, request.motion.times), places[key])
                case FollowTracked():
                    try:
                        tracks[follow] = tracked_track(follow, capture)
                    except StudioError as error:
                        raise StudioError(f"'{constraint.name}' follows a joint that is not there. {error}") from error
    return replace(request, tracks=tracks)
