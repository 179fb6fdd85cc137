"""Frames: the one frame of each body that a picture shows, solved for it as all is asked at that moment.

A frame is solved from its own pose alone (``core.solver.adapt.hold``), so it is what the whole clip has there, but for
the easing of what jolts. It costs less than a message to another thread: bodies follow the hand in the same picture.
"""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from studio.core.capture import Capture
from studio.core.errors import StudioError
from studio.core.morphology import Morphology
from studio.core.normalized.motion import NormalizedMotion
from studio.core.project import Performer, Project
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.rows import frame_count_of, timing_of
from studio.engine.solve_cache import SolveCache
from studio.engine.wanted import Wanted, player_of, wanted_of

Solve = Callable[[AdaptRequest, int, int | None], AdaptedMotion]

BUDGET = 0.012
"""Processor seconds that solving takes of a picture: whoever is left waits for the next, which begins with them."""
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
        self._not_before: dict[str, float] = {}

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
        performer_ids: Iterable[str],
        results: Mapping[str, AdaptedMotion],
    ) -> bool:
        """Solve what these performers do at ``seconds`` of the stage, leaders before those who follow them.

        False where not all had room in ``BUDGET``; the first has it always.
        """
        begun, all_there, solved = time.thread_time(), True, False
        for key in performer_ids:
            if key not in results or not all(map(self._prepare.holds, _captures_of(project, project.performers[key]))):
                continue  # nothing of it is seen yet
            if self._is_current(key, project) and not solved:
                continue
            row = _row_at(project, project.performers[key], seconds)
            known = self._frames.get(key)
            if known is not None and known.project is project and known.row == row and not solved:
                continue  # nor has anybody moved whom it may follow
            wanted = wanted_of(project, key, (key,), lambda leader: self._seen(leader, results))
            answered = self._answered.get(key)
            if wanted is None:
                self.drop(key)
            elif answered is not None and wanted == answered:
                self.drop(key)
                self._current[key] = project, answered
            elif known is not None and known.wanted == wanted and known.row == row:
                self._frames[key] = replace(known, project=project)
            elif time.monotonic() < self._not_before.get(key, 0.0):
                continue
            elif not solved or time.thread_time() - begun < BUDGET:
                solved = True
                self._bring(project, key, wanted, row, asked_at)
            else:
                all_there = False
        return all_there

    def _bring(self, project: Project, key: str, wanted: Wanted, row: int, asked_at: float) -> None:
        begun = time.thread_time()
        player = player_of(project, key, wanted, self._prepare)
        try:
            motion = self._solve(replace(player.request, eased=False), row, row)
        except StudioError:
            self.drop(key)  # the solve of the whole motion tells of it
            return
        self._frames[key] = Frame(project, wanted, row, replace(motion, composite=player.composite), asked_at)
        spent = time.thread_time() - begun
        if spent > LONG:
            self._not_before[key] = time.monotonic() + spent / PART

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
    return [project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.clips]


def _row_at(project: Project, performer: Performer, seconds: float) -> int:
    """As ``performance.row_at``, before there is a motion."""
    frame = round(timing_of(project, performer).frame_at(seconds))
    return min(max(frame, 0), frame_count_of(project, performer) - 1)
