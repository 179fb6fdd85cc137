"""Adaptation of a whole stage: every performer, after those that it follows."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.compose import Composite
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.performers.anticipated_targets import with_anticipated_targets
from studio.core.solver.performers.dependency_cycles import CycleMember, solve_cycle
from studio.core.solver.performers.rows import ClipConstraint, composite_of, constraints_in, corrections_in
from studio.core.solver.performers.stage import constraints_of_performer, leaders_first, tracks_followed_by, tracks_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project

PrepareCapture = Callable[[Capture], tuple[NormalizedMotion, Morphology]]
"""Function that normalises a capture and measures its actor; StudioError without a body map."""
SolveRequest = Callable[[AdaptRequest], AdaptedMotion]
"""Function that solves a request."""


@dataclass(frozen=True, eq=False)
class Performance:
    """One performer's composite motion, constraints, request and adapted motion."""

    composite: Composite
    clip_constraints: tuple[ClipConstraint, ...]
    request: AdaptRequest
    adapted: AdaptedMotion
    iterations: int = 0
    """Iterations of the performer's dependency cycle; 0 outside of one."""

    @property
    def adapted_on_stage(self) -> AdaptedMotion:
        """Adapted motion in those frames that play on the stage."""
        timing = self.composite.timing
        return self.adapted.frames(timing.first, timing.last)


@dataclass(frozen=True, eq=False)
class StagedPerformances:
    """Performances by performer id, and messages about performers that failed."""

    performances: Mapping[str, Performance]
    """Performances by performer id."""
    failures: Mapping[str, str] = field(default_factory=dict)
    """Message of each performer that failed, by performer id."""


def adapt_performers(
    project: Project, performer_ids: Iterable[str], prepare: PrepareCapture, solve: SolveRequest
) -> StagedPerformances:
    """Adapt the given performers and all that they follow; a failure affects only the performer and its followers."""
    known: dict[int, tuple[NormalizedMotion, Morphology]] = {}

    def prepared(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
        if id(capture) not in known:
            known[id(capture)] = prepare(capture)
        return known[id(capture)]

    done: dict[str, Performance] = {}
    failures: dict[str, str] = {}
    for circle in leaders_first(project, performer_ids):
        try:
            done |= _perform(project, circle, prepared, solve, done)
        except StudioError as error:
            failures |= dict.fromkeys(circle, str(error))
    return StagedPerformances(done, failures)


def _perform(
    project: Project,
    circle: tuple[str, ...],
    prepare: PrepareCapture,
    solve: SolveRequest,
    done: Mapping[str, Performance],
) -> dict[str, Performance]:
    """Performances of one dependency cycle, or of a performer by itself, given those ``done`` before."""

    def result_of(leader: str) -> AdaptedMotion:
        return _result(project, done, leader)

    players = {key: player_of(project, key, circle, prepare, result_of) for key in circle}
    asked = {key: constraints_of_performer(project, key) for key in circle}
    if len(circle) == 1:
        [(key, player)] = players.items()
        adapted = replace(solve(player.request), composite=player.composite)
        return {key: Performance(player.composite, asked[key], player.request, adapted)}
    found = solve_cycle(players, lambda _, request: solve(request))
    return {
        key: Performance(
            player.composite,
            asked[key],
            found.requests[key],
            replace(found.results[key], composite=player.composite),
            found.iterations,
        )
        for key, player in players.items()
    }


def _result(project: Project, done: Mapping[str, Performance], leader: str) -> AdaptedMotion:
    """Adapted motion of a ``leader`` that has been solved before."""
    if leader not in done:
        raise StudioError(f"It follows '{project.performers[leader].name}', which could not be adapted.")
    return done[leader].adapted


def player_of(
    project: Project,
    performer_id: str,
    circle: tuple[str, ...],
    prepare: PrepareCapture,
    result_of: Callable[[str], AdaptedMotion | None],
) -> CycleMember:
    """Performer with its request, without the tracks of the other members of its dependency cycle ``circle``.

    ``result_of`` gives the adapted motion of a leader outside the cycle.
    """
    performer = project.performers[performer_id]
    if not performer.clips or project.missing_references(performer):
        raise StudioError(f"'{performer.name}' has no clip, or the capture of its clip has been removed.")
    composite = composite_of(project, performer_id, lambda motion_id: motion_of(project, motion_id, prepare))
    request = unconstrained_request(project, performer_id, composite, prepare)
    constraints = constraints_in(
        constraints_of_performer(project, performer_id), composite, request.morphology.leg_length
    )
    followed = tracks_followed_by(project, performer_id, result_of, circle) or ()
    request = replace(
        request,
        constraints=constraints,
        tracks=with_anticipated_targets(tracks_of(followed, composite), constraints, composite.timing.frame_rate),
    )
    return CycleMember(request, composite, Placement.of(performer), project.props)


def unconstrained_request(
    project: Project, performer_id: str, composite: Composite, prepare: PrepareCapture
) -> AdaptRequest:
    """Request of a performer's composite motion on its body and ground, without constraints."""
    performer = project.performers[performer_id]
    character = project.characters[performer.character_id]
    timing, motion = composite.timing, composite.motion
    return AdaptRequest(
        motion,
        character.body_over(timing.begin, timing.frame_rate, motion.frame_count),
        composite.contacts,
        ground=project.ground.seen_from(performer.position, performer.heading),
        volume=character.volume,
        actor=_prepared(project, performer.clips[0].motion_id, prepare)[1],
        limited=performer.limited,
        eased=performer.eased,
        clears=performer.clears,
        corrections=corrections_in(project, performer_id, timing),
    )


def motion_of(project: Project, motion_id: str, prepare: PrepareCapture) -> NormalizedMotion:
    """Normalised motion with the id ``motion_id``."""
    return _prepared(project, motion_id, prepare)[0]


def _prepared(project: Project, motion_id: str, prepare: PrepareCapture) -> tuple[NormalizedMotion, Morphology]:
    """Normalised motion of the project, and its actor's measures."""
    return prepare(project.captures[project.motions[motion_id].capture_id])
