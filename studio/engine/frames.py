"""Single frames for the next image: the frame at the playhead of each performer, solved for the current request.

A frame is solved from its own pose (``core.solver.adapt.solve_constraints``), so it equals the frame of the whole clip
except for temporal smoothing. Performers that are being edited are solved on the window's thread before the image is
drawn, so that they follow the mouse in the same image. The others are solved in the background while the image is
drawn, half of them at a time, and appear in the next one. The cost of each frame is measured on either thread: a
performer that was slow once returns to the window's thread as soon as it is fast enough.
"""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.performers.dependency_cycles import solve_cycle
from studio.core.solver.performers.rows import frame_count_of, timing_of
from studio.core.solver.performers.stage import leaders_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.project import Performer, Project
from studio.engine.body_request import BodyRequest, Prepare, body_request_of, player_of
from studio.engine.solve_cache import SolveCache

Solve = Callable[[AdaptRequest, int, int | None], AdaptedMotion]
Cycle = tuple[str, ...]
"""Ids of performers that follow each other and are solved together; usually a single one."""

FRAME_BUDGET_SECONDS = 0.002
"""Processor seconds per image for performers that are not being edited; the rest are solved in the background."""
EDITED_FRAME_BUDGET_SECONDS = 0.2
"""Processor seconds per image for performers that are being edited.

Together with 50 ms of rendering, one event loop iteration takes at most a quarter of a second. In the background, a
pose would be late by one more image, and by the window's work in between.
"""
MANY_FRAMES, PIECE_FRAMES = 50_000, 2000
"""Number of frames of a cycle beyond which even its first frame is solved in the background, because grounding needs
all frames; and number of frames that cost as much as one more clip or loop: 4.7 ms beside 2.3 us per frame.
"""


@dataclass(frozen=True, eq=False)
class SolvedFrame:
    """Solved frame of one performer: the frame ``row`` of ``motion``, for ``project``. ``asked_at`` is the clock time
    of its request.
    """

    project: Project
    body_request: BodyRequest
    row: int
    motion: AdaptedMotion
    asked_at: float


@dataclass(frozen=True, eq=False)
class FrameResult:
    """Result of solving a cycle: frames by performer, empty if it cannot be solved or the whole motions in ``current``
    are up to date, and the processor seconds ``spent``.
    """

    cycle: Cycle
    project: Project
    asked_at: float
    frames: Mapping[str, SolvedFrame] = field(default_factory=dict)
    current: Mapping[str, BodyRequest] = field(default_factory=dict)
    spent: float = 0.0


@dataclass(frozen=True, eq=False)
class FrameJob:
    """Immutable input for solving one frame: ``results`` are whole motions that were solved for the requests
    ``answered``.

    Any thread may solve it; solved ``frames`` are inputs for the performers that follow.
    """

    project: Project
    seconds: float
    asked_at: float
    results: Mapping[str, AdaptedMotion]
    answered: Mapping[str, BodyRequest]
    frames: dict[str, SolvedFrame]
    prepare: Prepare
    solve: Solve

    def solved_cycle(self, cycle: Cycle) -> FrameResult:
        """Frames of the performers in a cycle for the current requests."""
        begun, project = time.thread_time(), self.project
        rows = {key: unsolved_row_at(project, project.performers[key], self.seconds) for key in cycle}
        asked = {key: body_request_of(project, key, cycle, self._seen) for key in cycle}
        wanted = {key: each for key, each in asked.items() if each is not None}
        known = {key: frame for key in cycle if (frame := self.frames.get(key)) and frame.row == rows[key]}
        if len(wanted) < len(cycle):
            return FrameResult(cycle, project, self.asked_at)
        if all(self.answered.get(key) == each for key, each in wanted.items()):
            current = {key: self.answered[key] for key in cycle}
            return FrameResult(cycle, project, self.asked_at, current=current)
        if {key: each.body_request for key, each in known.items()} == wanted:
            same = {key: replace(each, project=project, asked_at=self.asked_at) for key, each in known.items()}
            return FrameResult(cycle, project, self.asked_at, same)
        try:
            motions = self._motions(cycle, wanted, rows)
        except StudioError:
            return FrameResult(cycle, project, self.asked_at)  # the solve of the whole motion tells of it
        frames = {key: SolvedFrame(project, wanted[key], rows[key], motions[key], self.asked_at) for key in cycle}
        self.frames.update(frames)
        return FrameResult(cycle, project, self.asked_at, frames, spent=time.thread_time() - begun)

    def _motions(
        self, cycle: Cycle, wanted: Mapping[str, BodyRequest], rows: Mapping[str, int]
    ) -> Mapping[str, AdaptedMotion]:
        players = {key: player_of(self.project, key, each, self.prepare) for key, each in wanted.items()}

        def solve(key: str, request: AdaptRequest) -> AdaptedMotion:
            return self.solve(replace(request, eased=False), rows[key], rows[key])

        if len(cycle) == 1:
            motions = {key: solve(key, each.request) for key, each in players.items()}
        else:
            at_rows = {key: replace(each, frame=rows[key]) for key, each in players.items()}
            motions = dict(solve_cycle(at_rows, solve).results)
        return {key: replace(motion, composite=players[key].composite) for key, motion in motions.items()}

    def _seen(self, performer_id: str) -> AdaptedMotion | None:
        frame = self.frames.get(performer_id)
        return self.results.get(performer_id) if frame is None else frame.motion


class FrameStore:
    """Newest frame of every performer whose whole motion is not yet solved for the current request."""

    def __init__(
        self,
        prepare: SolveCache[Capture, tuple[NormalizedMotion, Morphology]],
        solve: Solve,
        answered: Mapping[str, BodyRequest],
    ) -> None:
        """``answered``: for each performer the request that its newest whole motion was solved for; updated as results
        arrive.
        """
        self._prepare, self._solve, self._answered = prepare, solve, answered
        self._frames: dict[str, SolvedFrame] = {}
        self._current: dict[str, FrameResult] = {}
        """Latest outcome, by performer, in which the newest whole motion is up to date."""
        self._whole_at: dict[str, float] = {}
        """Time of the request that the newest whole motion answers, by performer."""
        self._costs: dict[Cycle, float] = {}
        """Processor seconds of the last solved frame, by cycle."""
        self._looked_at: dict[Cycle, float] = {}
        """Time of the request of the last outcome, by cycle."""
        self._driven: set[str] = set()

    def get(self, performer_id: str) -> SolvedFrame | None:
        """Newest frame of a performer; None if there is none."""
        return self._frames.get(performer_id)

    def drop_frame(self, performer_id: str) -> None:
        """Discard the frame of a performer."""
        self._frames.pop(performer_id, None)

    def note_whole_motion(self, performer_id: str, asked_at: float) -> None:
        """Record that the whole motion for the request at clock time ``asked_at`` is solved; a frame that is not newer
        is discarded.
        """
        self._whole_at[performer_id] = asked_at
        frame, answered = self._frames.get(performer_id), self._answered.get(performer_id)
        if frame is not None and (frame.asked_at <= asked_at or frame.body_request == answered):
            self.drop_frame(performer_id)

    def asked_at(self, performer_id: str) -> float:
        """Clock time of the latest request that the frame of a performer, or without one its whole motion, was solved
        for.

        0 if there is none.
        """
        if (frame := self._frames.get(performer_id)) is not None:
            return frame.asked_at
        outcome = self._current.get(performer_id)
        answers = outcome is not None and outcome.current[performer_id] is self._answered.get(performer_id)
        return outcome.asked_at if outcome is not None and answers else 0.0

    def clear(self) -> None:
        """Discard all frames, for another project."""
        for held in (self._frames, self._current, self._whole_at, self._costs, self._looked_at):
            held.clear()

    def solve_frames(
        self,
        project: Project,
        seconds: float,
        asked_at: float,
        first: Sequence[Cycle],
        others: Sequence[Cycle],
        results: Mapping[str, AdaptedMotion],
        driven: Mapping[str, AdaptedMotion],
    ) -> Callable[[], Sequence[FrameResult]] | None:
        """Solve the frames of performers at the stage time ``seconds``, leaders before their followers.

        Performers ``driven`` by live input are not solved here; their followers are, in every image. Cycles whose last
        cost exceeds the remaining time (``EDITED_FRAME_BUDGET_SECONDS`` for ``first``, ``FRAME_BUDGET_SECONDS`` for
        ``others``) are left to the returned function: any thread may call it, and its results are passed to ``take``.
        """
        if not self._driven <= driven.keys():
            self._frames.clear()  # who followed somebody that was driven follows its clips again
        self._driven = {*driven}
        frames = {key: frame for key, frame in self._frames.items() if key not in driven}
        instant = FrameJob(
            project=project,
            seconds=seconds,
            asked_at=asked_at,
            results={**results, **driven},
            answered=dict(self._answered),
            frames=frames,
            prepare=self._prepare,
            solve=self._solve,
        )
        begun, solved, left, moving = time.thread_time(), False, list[Cycle](), {*driven}
        for whole in (*first, *others):
            cycle = tuple(key for key in whole if key not in driven)
            if not all(key in results and self._is_prepared(project, key) for key in cycle):
                continue  # nothing of it is seen yet
            follows = bool(moving) and any(leaders_of(project, key) & moving for key in cycle)
            if not (solved or left or follows) and self._is_seen(cycle, project, seconds):
                continue  # nor has anybody moved whom it may follow
            moving |= {*cycle} if follows else set()
            elapsed, limit = (
                time.thread_time() - begun,
                EDITED_FRAME_BUDGET_SECONDS if whole in first else FRAME_BUDGET_SECONDS,
            )
            has_room = elapsed + self._costs.get(cycle, 0.0) <= limit and not _is_long(cycle, project)
            waits = bool(left) and any(leaders_of(project, key) & {*chain(*left)} for key in cycle)
            if not follows and (waits or not has_room):
                left.append(cycle)
                continue
            outcome = instant.solved_cycle(cycle)
            solved |= bool(outcome.spent)
            self._put(outcome)
        turn = self._next_cycles(left, first, project)
        return (lambda: [instant.solved_cycle(cycle) for cycle in turn]) if turn else None

    def _next_cycles(self, left: list[Cycle], first: Sequence[Cycle], project: Project) -> list[Cycle]:
        """Cycles to be solved in the background next: the first edited one and half of the rest, least recently solved
        first.

        All of them if any follows a leader, so that followers stay in step with their leaders.
        """
        if any(leaders_of(project, key) for cycle in left for key in cycle):
            return left
        ahead = [cycle for cycle in left if cycle in first][:1]
        rest = sorted((each for each in left if each not in ahead), key=lambda each: self._looked_at.get(each, 0.0))
        return ahead + rest[: (len(rest) + 1) // 2]

    def take(self, outcomes: Iterable[FrameResult]) -> list[str]:
        """Store frames solved in the background that are not older than the stored ones; returns the ids of the updated
        performers.
        """
        news = [outcome for outcome in outcomes if all(self._is_older(key, outcome) for key in outcome.cycle)]
        for outcome in news:
            self._put(outcome)
        return [key for outcome in news if outcome.spent for key in outcome.cycle]

    def _is_older(self, performer_id: str, outcome: FrameResult) -> bool:
        whole_at = self._whole_at.get(performer_id, 0.0)
        return self.asked_at(performer_id) <= outcome.asked_at and whole_at < outcome.asked_at

    def _put(self, outcome: FrameResult) -> None:
        self._looked_at[outcome.cycle] = outcome.asked_at
        if outcome.spent:
            self._costs[outcome.cycle] = outcome.spent
        for key in outcome.cycle:
            self.drop_frame(key)
        self._frames |= outcome.frames
        self._current |= dict.fromkeys(outcome.current, outcome)

    def _is_prepared(self, project: Project, performer_id: str) -> bool:
        return all(map(self._prepare.is_cached, _captures_of(project, project.performers[performer_id])))

    def _is_seen(self, cycle: Cycle, project: Project, seconds: float) -> bool:
        """True if the frames, or whole motions, of a cycle are up to date with ``project``."""
        if all(self._is_current(key, project) for key in cycle):
            return True
        rows = {key: unsolved_row_at(project, project.performers[key], seconds) for key in cycle}
        frames = {key: frame for key in cycle if (frame := self._frames.get(key))}
        return len(frames) == len(cycle) and all(
            frame.project is project and frame.row == rows[key] for key, frame in frames.items()
        )

    def _is_current(self, performer_id: str, project: Project) -> bool:
        """True if the newest whole motion of a performer is up to date with ``project``."""
        if performer_id in self._frames or performer_id not in self._current:
            return False
        outcome = self._current[performer_id]
        return outcome.project is project and outcome.current[performer_id] is self._answered.get(performer_id)


def _is_long(cycle: Cycle, project: Project) -> bool:
    performers = [project.performers[key] for key in cycle]
    frames = sum(frame_count_of(project, each) for each in performers)
    pieces = sum(clip.repeats for each in performers for clip in each.all_clips)
    return frames + PIECE_FRAMES * pieces > MANY_FRAMES


def _captures_of(project: Project, performer: Performer) -> list[Capture]:
    return [project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.all_clips]


def unsolved_row_at(project: Project, performer: Performer, seconds: float) -> int:
    """Index of the frame at the stage time ``seconds`` in the motion of a performer that has no result yet."""
    frame = round(timing_of(project, performer).frame_at(seconds))
    return min(max(frame, 0), frame_count_of(project, performer) - 1)
