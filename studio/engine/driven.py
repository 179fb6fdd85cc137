"""Performers driven by live input: their pose comes from the input, and the constraints of their clips apply to it."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.performers.rows import frame_count_of, timing_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.project import Project
from studio.engine.body_request import BodyRequest, Prepare, body_request_of, player_of

if TYPE_CHECKING:
    from studio.live.live_grounding import LiveGrounding

PoseSource = Callable[[], NormalizedMotion | None]
"""Function that returns the newest received pose as a still motion; None if there is none."""


class DrivenPerformers:
    """Newest pose of every performer that is driven by a live source, adapted to its body."""

    def __init__(self, prepare: Prepare) -> None:
        self._prepare = prepare
        self._sources: dict[str, PoseSource] = {}
        self._shown: dict[str, AdaptedMotion] = {}
        self._requests: dict[str, tuple[BodyRequest, AdaptRequest]] = {}
        self._planted: dict[str, LiveGrounding] = {}
        self.problems: dict[str, str] = {}
        """Sentence by performer id: the reason why the performer cannot play its input."""

    def drive(self, performer_id: str, source: PoseSource | None) -> None:
        """Drive a performer by ``source``; None lets it play its clips again."""
        for held in (self._sources, self._shown, self._requests, self._planted, self.problems):
            held.pop(performer_id, None)
        if source is not None:
            self._sources[performer_id] = source

    @property
    def poses(self) -> Mapping[str, AdaptedMotion]:
        """Current poses of all driven performers that receive input, by id."""
        return self._shown

    def pose_of(self, performer_id: str) -> AdaptedMotion | None:
        """Current pose of a driven performer; None if it is not driven or receives no input."""
        return self._shown.get(performer_id)

    def solve_newest_poses(self, project: Project, seconds: float, results: Mapping[str, AdaptedMotion]) -> None:
        """Solve the newest poses of all driven performers, with the constraints at the stage time ``seconds``."""
        for key, source in self._sources.items():
            pose = source() if key in project.performers else None
            if pose is None:
                self._shown.pop(key, None)
                continue
            try:
                self._shown[key] = self._solved(project, key, seconds, pose, results)
                self.problems.pop(key, None)
            except StudioError as error:
                self.problems[key] = str(error)

    def _solved(
        self, project: Project, key: str, seconds: float, pose: NormalizedMotion, results: Mapping[str, AdaptedMotion]
    ) -> AdaptedMotion:
        from studio.live.driving import driven_frame  # loads the solver
        from studio.live.live_grounding import LiveGrounding

        performer, clock = project.performers[key], time.monotonic()
        planted = self._planted.setdefault(key, LiveGrounding())
        if not performer.clips:
            body = project.characters[performer.character_id].morphology
            ground = project.ground.seen_from(performer.position, performer.heading)
            return driven_frame(AdaptRequest(pose, body, ground=ground), 0, pose, planted, clock)
        known = results.get(key)
        wanted = body_request_of(project, key, (key,), results.get)
        if wanted is None or known is None:
            raise StudioError(f"{performer.name} follows a character that is not adapted yet. Wait until it is.")
        if key not in self._requests or self._requests[key][0] != wanted:
            self._requests[key] = wanted, player_of(project, key, wanted, self._prepare).request
        row = round(timing_of(project, performer).frame_at(seconds))
        row = min(max(row, 0), frame_count_of(project, performer) - 1)
        return replace(driven_frame(self._requests[key][1], row, pose, planted, clock), composite=known.composite)
