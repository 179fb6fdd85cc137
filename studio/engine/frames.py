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

    def get(self, performer_id: str) -> Frame | None:
        """The frame of one performer."""
        return self._frames.get(performer_id)

    def drop(self, performer_id: str) -> None:
        """The whole motion is there."""
        self._frames.pop(performer_id, None)

    def drop_answered(self, performer_id: str) -> None:
        """As ``drop``, where that is what the frame answers."""
        frame = self._frames.get(performer_id)
        if frame is not None and frame.wanted == self._answered.get(performer_id):
            self.drop(performer_id)

    def asked_at(self, performer_id: str) -> float:
        """When that was asked which the frame of one performer answers; 0 where there is none."""
        frame = self._frames.get(performer_id)
        return 0.0 if frame is None else frame.asked_at

    def clear(self) -> None:
        """Another project is shown."""
        self._frames.clear()

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
            row = _row_at(project, project.performers[key], seconds)
            known = self._frames.get(key)
            if known is not None and known.project is project and known.row == row and not solved:
                continue  # nor has anybody moved whom it may follow
            wanted = wanted_of(project, key, (key,), lambda leader: self._seen(leader, results))
            if wanted is None or wanted == self._answered.get(key):
                self.drop(key)
            elif known is not None and known.wanted == wanted and known.row == row:
                self._frames[key] = replace(known, project=project)
            elif not solved or time.thread_time() - begun < BUDGET:
                solved = True
                self._bring(project, key, wanted, row, asked_at)
            else:
                all_there = False
        return all_there

    def _bring(self, project: Project, key: str, wanted: Wanted, row: int, asked_at: float) -> None:
        player = player_of(project, key, wanted, self._prepare)
        try:
            motion = self._solve(replace(player.request, eased=False), row, row)
        except StudioError:
            self.drop(key)  # the solve of the whole motion tells of it
            return
        self._frames[key] = Frame(project, wanted, row, replace(motion, composite=player.composite), asked_at)

    def _seen(self, performer_id: str, results: Mapping[str, AdaptedMotion]) -> AdaptedMotion | None:
        frame = self._frames.get(performer_id)
        return results.get(performer_id) if frame is None else frame.motion


def _captures_of(project: Project, performer: Performer) -> list[Capture]:
    return [project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.clips]


def _row_at(project: Project, performer: Performer, seconds: float) -> int:
    """As ``performance.row_at``, before there is a motion."""
    frame = round(timing_of(project, performer).frame_at(seconds))
    return min(max(frame, 0), frame_count_of(project, performer) - 1)
