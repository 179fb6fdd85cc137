"""Frames: the one frame of each body that a picture shows, solved for it as all is asked at that moment.

A frame is solved from its own pose alone (``core.solver.adapt.hold``), so it is what the whole clip has there, but for
the easing of what jolts. It costs less than a message to another thread: bodies follow the hand in the same picture.
"""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.project import Performer, Project
from studio.core.solver.performers.circles import solve_circle
from studio.core.solver.performers.rows import frame_count_of, timing_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.engine.solve_cache import SolveCache
from studio.engine.wanted import Wanted, player_of, wanted_of

Solve = Callable[[AdaptRequest, int, int | None], AdaptedMotion]

BUDGET = 0.004
"""Processor seconds after which no other body is begun in a picture: the next begins with who is left."""
LONG, PART = 0.05, 0.2
"""Processor seconds above which a frame would make the window slow: then it takes this part of the time at most."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A row of a performer's motion as ``project`` asks it; ``asked_at`` as ``Live.asked_at``."""

    project: Project
    wanted: Wanted
    row: int
    motion: AdaptedMotion
    asked_at: float


class Frames:
    """The newest frame of every performer whose whole motion is not solved yet as it is asked now."""

    def __init__(
        self, prepare: SolveCache[tuple[NormalizedMotion, Morphology]], solve: Solve, answered: Mapping[str, Wanted]
    ) -> None:
        """``answered``: what the newest whole motion of each performer answers; it changes as answers come."""
        self._prepare, self._solve, self._answered = prepare, solve, answered
        self._frames: dict[str, Frame] = {}
        self._current: dict[str, tuple[Project, Wanted]] = {}
        """With what project the newest whole motion was found to be what is asked."""
        self._not_before: dict[tuple[str, ...], float] = {}

    def get(self, performer_id: str) -> Frame | None:
        """The frame of one performer."""
        return self._frames.get(performer_id)

    def drop(self, performer_id: str) -> None:
        """The whole motion is there."""
        self._frames.pop(performer_id, None)

    def drop_older(self, performer_id: str, asked_at: float) -> None:
        """As ``drop``, where the whole motion answers what was asked at ``asked_at``, and the frame nothing newer."""
        if self.asked_at(performer_id) <= asked_at:
            self.drop(performer_id)

    def asked_at(self, performer_id: str) -> float:
        """When that was asked which the frame of one performer answers; 0 where there is none."""
        frame = self._frames.get(performer_id)
        return 0.0 if frame is None else frame.asked_at

    def clear(self) -> None:
        """Another project is shown."""
        for held in (self._frames, self._current, self._not_before):
            held.clear()

    def bring(
        self,
        project: Project,
        seconds: float,
        asked_at: float,
        circles: Iterable[tuple[str, ...]],
        results: Mapping[str, AdaptedMotion],
    ) -> bool:
        """Solve what performers do at ``seconds`` of the stage, leaders before those who follow them.

        Who follow each other, a circle, are solved together. False where not all had room in ``BUDGET``; the first has
        it always.
        """
        begun, all_there, solved = time.thread_time(), True, False
        for circle in circles:
            if not all(key in results and self._is_prepared(project, key) for key in circle):
                continue  # nothing of it is seen yet
            if not solved and all(self._is_current(key, project) for key in circle):
                continue
            rows = {key: _row_at(project, project.performers[key], seconds) for key in circle}
            known = {key: frame for key in circle if (frame := self._frames.get(key)) and frame.row == rows[key]}
            if not solved and len(known) == len(circle) and all(each.project is project for each in known.values()):
                continue  # nor has anybody moved whom it may follow
            asked = {key: wanted_of(project, key, circle, lambda leader: self._seen(leader, results)) for key in circle}
            wanted = {key: each for key, each in asked.items() if each is not None}
            if len(wanted) < len(circle):
                self._drop(circle)
            elif all(self._answered.get(key) == each for key, each in wanted.items()):
                self._drop(circle)
                self._current |= {key: (project, self._answered[key]) for key in circle}
            elif {key: each.wanted for key, each in known.items()} == wanted:
                self._frames |= {key: replace(each, project=project) for key, each in known.items()}
            elif time.monotonic() < self._not_before.get(circle, 0.0):
                continue
            elif not solved or time.thread_time() - begun < BUDGET:
                solved = True
                self._bring(project, circle, wanted, rows, asked_at)
            else:
                all_there = False
        return all_there

    def _bring(
        self,
        project: Project,
        circle: tuple[str, ...],
        wanted: Mapping[str, Wanted],
        rows: Mapping[str, int],
        asked_at: float,
    ) -> None:
        begun = time.thread_time()
        players = {key: player_of(project, key, each, self._prepare) for key, each in wanted.items()}

        def solve(key: str, request: AdaptRequest) -> AdaptedMotion:
            return self._solve(replace(request, eased=False), rows[key], rows[key])

        try:
            if len(circle) == 1:
                motions = {key: solve(key, each.request) for key, each in players.items()}
            else:
                at_rows = {key: replace(each, frame=rows[key]) for key, each in players.items()}
                motions = dict(solve_circle(at_rows, solve).results)
        except StudioError:
            self._drop(circle)  # the solve of the whole motion tells of it
            return
        for key, motion in motions.items():
            played = replace(motion, composite=players[key].composite)
            self._frames[key] = Frame(project, wanted[key], rows[key], played, asked_at)
        spent = time.thread_time() - begun
        if spent > LONG:
            self._not_before[circle] = time.monotonic() + spent / PART

    def _is_prepared(self, project: Project, performer_id: str) -> bool:
        return all(map(self._prepare.holds, _captures_of(project, project.performers[performer_id])))

    def _drop(self, circle: tuple[str, ...]) -> None:
        for key in circle:
            self.drop(key)

    def _is_current(self, performer_id: str, project: Project) -> bool:
        """Whether the newest whole motion was found to be what is asked, and neither has changed since."""
        if performer_id in self._frames or performer_id not in self._current:
            return False
        known, wanted = self._current[performer_id]
        return known is project and wanted is self._answered.get(performer_id)

    def _seen(self, performer_id: str, results: Mapping[str, AdaptedMotion]) -> AdaptedMotion | None:
        frame = self._frames.get(performer_id)
        return results.get(performer_id) if frame is None else frame.motion


def _captures_of(project: Project, performer: Performer) -> list[Capture]:
    return [project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.all_clips]


def _row_at(project: Project, performer: Performer, seconds: float) -> int:
    """As ``performance.row_at``, before there is a motion."""
    frame = round(timing_of(project, performer).frame_at(seconds))
    return min(max(frame, 0), frame_count_of(project, performer) - 1)
