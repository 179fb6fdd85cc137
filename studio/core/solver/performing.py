"""A whole stage adapted: every performer as it plays its row of clips among the others."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from studio.core.capture import Capture
from studio.core.errors import StudioError
from studio.core.morphology import Morphology
from studio.core.normalized.compose import Composite
from studio.core.normalized.motion import NormalizedMotion
from studio.core.placement import Placement
from studio.core.project import Project
from studio.core.solver.circles import Player, solve_circle
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.rows import Asked, composite_of, constraints_in
from studio.core.solver.stage import asked_of, followed_by, in_order, tracks_of

Prepare = Callable[[Capture], tuple[NormalizedMotion, Morphology]]
"""A capture's motion and its actor's measures; StudioError where it has no body map."""
Solve = Callable[[AdaptRequest], AdaptedMotion]


@dataclass(frozen=True, eq=False)
class Performance:
    """What one performer plays, what was asked of it, and what came of it."""

    composite: Composite
    asked: tuple[Asked, ...]
    request: AdaptRequest
    adapted: AdaptedMotion
    sweeps: int = 0
    """How often all were solved who follow each other in a circle with it; 0 outside of one."""

    @property
    def played(self) -> AdaptedMotion:
        """The frames of it that play on the stage."""
        timing = self.composite.timing
        return self.adapted.frames(timing.first, timing.last)


@dataclass(frozen=True, eq=False)
class Staged:
    """Performances by performer, and why others failed."""

    performances: Mapping[str, Performance]
    failures: Mapping[str, str] = field(default_factory=dict)


def perform(project: Project, performer_ids: Iterable[str], prepare: Prepare, solve: Solve) -> Staged:
    """Adapt these performers and all whom they follow; one that fails takes down only who follows it."""
    known: dict[int, tuple[NormalizedMotion, Morphology]] = {}

    def prepared(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
        if id(capture) not in known:
            known[id(capture)] = prepare(capture)
        return known[id(capture)]

    done: dict[str, Performance] = {}
    failures: dict[str, str] = {}
    for circle in in_order(project, performer_ids):
        try:
            done |= _perform(project, circle, prepared, solve, done)
        except StudioError as error:
            failures |= dict.fromkeys(circle, str(error))
    return Staged(done, failures)


def _perform(
    project: Project, circle: tuple[str, ...], prepare: Prepare, solve: Solve, done: Mapping[str, Performance]
) -> dict[str, Performance]:

    def result_of(leader: str) -> AdaptedMotion:
        return _result(project, done, leader)

    players = {key: player_of(project, key, circle, prepare, result_of) for key in circle}
    asked = {key: asked_of(project, key) for key in circle}
    if len(circle) == 1:
        [(key, player)] = players.items()
        adapted = replace(solve(player.request), composite=player.composite)
        return {key: Performance(player.composite, asked[key], player.request, adapted)}
    found = solve_circle(players, solve)
    return {
        key: Performance(
            player.composite,
            asked[key],
            found.requests[key],
            replace(found.results[key], composite=player.composite),
            found.sweeps,
        )
        for key, player in players.items()
    }


def _result(project: Project, done: Mapping[str, Performance], leader: str) -> AdaptedMotion:
    if leader not in done:
        raise StudioError(f"It follows '{project.performers[leader].name}', who could not be adapted.")
    return done[leader].adapted


def player_of(
    project: Project,
    performer_id: str,
    circle: tuple[str, ...],
    prepare: Prepare,
    result_of: Callable[[str], AdaptedMotion | None],
) -> Player:
    """A performer with all that is asked of it, but where the others of its circle are."""
    performer = project.performers[performer_id]
    if not performer.clips or project.missing_references(performer):
        raise StudioError(f"'{performer.name}' plays nothing, or what it played is not there any more.")
    captures = {clip.motion_id: project.motions[clip.motion_id].capture_id for clip in performer.clips}
    motions = {motion_id: prepare(project.captures[capture_id]) for motion_id, capture_id in captures.items()}
    composite = composite_of(project, performer_id, lambda motion_id: motions[motion_id][0])
    character = project.characters[performer.character_id]
    timing, count = composite.timing, composite.motion.frame_count
    body = character.body_over(timing.begin, timing.frame_rate, count)
    request = AdaptRequest(
        composite.motion,
        body,
        composite.contacts,
        constraints_in(asked_of(project, performer_id), composite, body.leg_length),
        project.ground.seen_from(performer.position, performer.heading),
        volume=character.volume,
        actor=motions[performer.clips[0].motion_id][1],
        limited=performer.limited,
        eased=performer.eased,
        clears=performer.clears,
    )
    followed = followed_by(project, performer_id, result_of, circle) or ()
    request = replace(request, tracks=tracks_of(followed, composite))
    return Player(request, composite, Placement.of(performer))
