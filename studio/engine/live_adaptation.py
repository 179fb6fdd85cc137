"""Adaptation while editing: keeps every visible performer's adapted motion up to date with the document."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import QCoreApplication, QObject, QTimer, Signal

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.project_cache import forget_project
from studio.core.solver.performers.dependency_cycles import solve_cycle
from studio.core.solver.performers.rows import frame_count_of, timing_of
from studio.core.solver.performers.stage import leaders_first, leaders_of
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Performer, Project
from studio.document.document import Document
from studio.engine.body_request import BodyRequest, Prepare, body_request_of, player_of
from studio.engine.driven import DrivenPerformers
from studio.engine.frames import Cycle, FrameResult, FrameStore, Solve
from studio.engine.live_play import LivePlay
from studio.engine.mouse_timestamps import MouseTimestamps, RestTimer
from studio.engine.scheduler import SolveScheduler
from studio.engine.solve_cache import SolveCache
from studio.engine.solver_kernels import SolverKernels
from studio.engine.standing_solver import GroundingSolver
from studio.startup.kernel_warm_up import WarmUp

WINDOW_SECONDS = 0.75
WINDOW_MILLISECONDS, IDLE_MILLISECONDS = 120, 150
"""Interval between two solved windows during a drag, and idle time after which whole motions are solved."""
SOLVE_REPORT_MILLISECONDS, DRAG_REPORT_MILLISECONDS = 100, 250
"""Delays from a new result until forms, error strips and graphs show it, after a solve and during a drag; results in
between are shown together.
"""
_SOURCE, _EXPECTED, _FRAMES, _TOGETHER = "source ", "expected ", "frames", "\n"

Realise = Callable[[NormalizedMotion, Morphology], AdaptedMotion]


def normalized_with_actor(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
    """Normalised motion of a capture, and the morphology of its actor."""
    from studio.core.normalized.normalize import normalize_capture

    motion, actor = normalize_capture(capture)
    return motion, actor.morphology


def as_recorded(motion: NormalizedMotion, actor: Morphology) -> AdaptedMotion:
    """Motion on the body of the actor with which it was recorded."""
    from studio.core.normalized.realize import realize_motion

    positions, rotations = realize_motion(motion, actor, play=True)
    return AdaptedMotion(actor, motion.frame_rate, 0, positions, rotations, np.empty((0, len(positions))))


@dataclass(frozen=True, eq=False)
class SolveResults:
    """Results of a worker by performer id, with their requests and clock time; ``whole`` is True for whole motions."""

    adapted: Mapping[str, AdaptedMotion]
    wanted: Mapping[str, BodyRequest]
    asked_at: float
    whole: bool


class LiveAdaptation(QObject):
    """Solver front end that requests a solve whenever an input of a visible performer changes."""

    adapted = Signal(str)
    reported_changed = Signal()
    busy_changed = Signal(bool)
    interactive_changed = Signal(bool)

    def __init__(
        self,
        document: Document,
        prepare: Prepare = normalized_with_actor,
        solve: Solve | None = None,
        realise: Realise = as_recorded,
        parent: QObject | None = None,
        workers: int | None = None,
        warm_up: WarmUp | None = None,
    ) -> None:
        """Solves wait until the kernels they need are compiled."""
        super().__init__(parent)
        self._document = document
        self._prepare = SolveCache(prepare)
        self._standing = GroundingSolver()
        self._solve, self._realise = solve or self._standing, realise
        self._kernels = SolverKernels(warm_up, self)
        self._wanted: dict[str, BodyRequest] = {}
        self._results: dict[str, AdaptedMotion] = {}
        self._answered: dict[str, BodyRequest] = {}
        self._told: dict[str, AdaptedMotion] = {}
        self._failures: dict[str, str] = {}
        self._sources: dict[str, tuple[Capture, AdaptedMotion | None]] = {}
        self._busy = False
        self._leaders: set[str] = set()
        self._circles: set[tuple[str, ...]] = set()
        self._works_on_former = False
        self._unfinished: set[tuple[str, ...]] = set()
        """Circles of which no more than a window has been asked."""
        self._frames = FrameStore(self._prepare, self._solve, self._answered)
        self.driven = DrivenPerformers(self._prepare)
        self._interactive = False
        self._asked_at: dict[str, float] = {}
        self._hand = MouseTimestamps(self)
        self._changed_at = time.monotonic()
        self._scheduler, self._beside = SolveScheduler(self, workers), SolveScheduler(self, workers=1)
        self._hear_workers()
        # Several changes of one event-loop turn (a group, a cascade) ask for one solve.
        self.play = LivePlay(document, self._prepare, self, lambda: self.ready)
        self.play.running_changed.connect(self._play_changed)
        self._turn = QTimer(self, singleShot=True, interval=0)
        self._turn.timeout.connect(lambda: self._refresh(whole=not self._interactive))
        self._kernels.changed.connect(self._kernels_changed)
        self._rest = RestTimer(IDLE_MILLISECONDS, self)
        self._rest.rested.connect(lambda: self._refresh(whole=True))
        self._telling = QTimer(self, singleShot=True)
        self._telling.timeout.connect(self._tell_results)
        document.entity_changed.connect(self._schedule)
        document.project_opened.connect(self._begin_anew)
        self._refresh(whole=True)

    def _hear_workers(self) -> None:
        self._scheduler.answered.connect(self._take)
        self._scheduler.failed.connect(self._tell)
        self._scheduler.settled.connect(self._tell_busy)
        self._beside.answered.connect(self._take_frames)
        self._beside.failed.connect(_raise)

    @property
    def interactive(self) -> bool:
        """True during a drag; see ``Live.interactive``."""
        return self._interactive

    @interactive.setter
    def interactive(self, value: bool) -> None:
        if value != self._interactive:
            self._interactive = value
            self._hand.set_listening(value)
            if not value and not self.play.running:
                if self._telling.isActive():
                    self._telling.start(SOLVE_REPORT_MILLISECONDS)  # reported once: with all that is asked now
                self._rest.stop()
                self._turn.start(0)
            self.interactive_changed.emit(value)

    def asked_at(self, performer_id: str) -> float | None:
        """Clock time of the latest request that the displayed pose was solved for; None if there is none."""
        if self.play.running:
            return None
        return self._frames.asked_at(performer_id) or self._asked_at.get(performer_id)

    @property
    def ready(self) -> bool:
        """True once the kernels of constraints are compiled."""
        return self._kernels.ready

    def _kernels_changed(self) -> None:
        self._refresh(whole=True)
        self.reported_changed.emit()

    def failure(self, performer_id: str) -> str:
        """Sentence why a performer cannot be adapted; empty if it can be, or is being solved."""
        return self._failures.get(performer_id, "")

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """Newest adapted motion of a performer; during a drag with the newest solved window merged into it. None if
        there is none.
        """
        return self._results.get(performer_id)

    def solve_frame(self, seconds: float) -> None:
        """Solve the frame at the stage time ``seconds`` of every performer whose newest motion is out of date."""
        if not self._kernels.grounded:
            return
        project = self._document.project
        if self.ready:
            self.driven.solve_newest_poses(project, seconds, self._results)
        if self.play.running:
            self.play.allow_next_step()
            return
        first, others = self._edited_first(project)
        left = self._frames.solve_frames(
            project, seconds, self._changed_at, first, others, self._results, self.driven.poses
        )
        if left is not None:
            self._beside.request(_FRAMES, self._document.revision, left)

    def _edited_first(self, project: Project) -> tuple[list[Cycle], list[Cycle]]:
        """Cycles of edited performers and those they follow, and all other cycles; leaders before their followers."""
        cycles = [cycle for cycle in _cycles_of(project) if self._kernels.can_solve(project, cycle)]
        playing = [key for cycle in cycles for key in cycle]
        active = [key for key in playing if key == self._document.active_performer_id]
        first = dict.fromkeys((*leaders_first(project, active), *leaders_first(project, self._selected(playing))))
        return [each for each in first if each in cycles], [each for each in cycles if each not in first]

    def _selected(self, performer_ids: Iterable[str]) -> list[str]:
        """Ids of the edited performers: the selected ones, else the active one."""
        selected = {*self._document.selection.of("performers")} or {self._document.active_performer_id or ""}
        return [key for key in performer_ids if key in selected]

    def shown_frame(self, performer_id: str) -> AdaptedMotion | None:
        """Motion to display: a frame that was solved for the current request, else the newest adapted motion. None if
        there is none.
        """
        driven, frame = self.driven.pose_of(performer_id), self._frames.get(performer_id)
        if driven is not None:
            return driven
        if self.play.moment is not None:
            return self.play.moment.results.get(performer_id)
        return self._results.get(performer_id) if frame is None else frame.motion

    def is_eased(self, performer_id: str) -> bool:
        """True if the displayed pose is smoothed as requested; a single solved frame is not."""
        if self.play.running:
            return True
        frame = self._frames.get(performer_id)
        return frame is None or not (frame.body_request.eased and frame.body_request.constraints)

    def reported_motion(self, performer_id: str) -> AdaptedMotion | None:
        """Motion from which views report residuals; updated a tenth of a second after results arrive or become
        outdated. None while the whole motion is not solved.
        """
        told = self._told.get(performer_id)
        if self.interactive:
            return told
        return told if told is self._results.get(performer_id) and self._is_current(performer_id) else None

    def _is_current(self, performer_id: str) -> bool:
        """True if the newest result is a whole motion and up to date."""
        wanted = self._wanted.get(performer_id)
        if wanted is None or self._answered.get(performer_id) is not wanted:
            return False
        if not self._turn.isActive():
            return True
        project = self._document.project
        performer = project.performers.get(performer_id)
        if performer is None or not performer.clips or project.missing_references(performer):
            return False
        cycle = next((each for each in self._circles if performer_id in each), (performer_id,))
        return body_request_of(project, performer_id, cycle, self._results.get) == wanted

    def _report_soon(self) -> None:
        if not self._telling.isActive():
            self._telling.start(DRAG_REPORT_MILLISECONDS if self._interactive else SOLVE_REPORT_MILLISECONDS)

    def _tell_results(self) -> None:
        self._told = dict(self._results)
        self.reported_changed.emit()

    def motion(self, motion_id: str) -> NormalizedMotion:
        """Normalised motion with an id of the project."""
        project = self._document.project
        return self._prepare(project.captures[project.motions[motion_id].capture_id])[0]

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """Source motion on the actor's own body; None until it is ready, after which ``adapted`` is emitted."""
        motion = self._document.project.motions.get(motion_id)
        capture = self._document.project.captures.get(motion.capture_id) if motion else None
        if capture is None:
            return None
        known = self._sources.get(motion_id)
        if known is None or known[0] is not capture:
            self._sources[motion_id] = (capture, None)
            key, revision = _SOURCE + motion_id, self._document.revision
            self._scheduler.request(key, revision, lambda: self._realised(capture))
            self._tell_busy()
            return None
        return known[1]

    def show_until_solved(self, motions: Mapping[str, AdaptedMotion]) -> None:
        """Show stored adapted motions of performers whose solves may have to wait for the kernels."""
        for key in motions.keys() & {key for cycle in self._circles for key in cycle}:
            self._results[key] = motions[key]
            self.adapted.emit(key)

    def prefetch_capture(self, capture: Capture) -> None:
        """Start normalising a capture in the background before it is shown; may be called from any thread."""
        if capture.body_map is not None:
            self._scheduler.request(f"{_EXPECTED}{id(capture)}", 0, lambda: self._prepared(capture))

    def wait_until_solved(self, timeout: float = 10.0) -> bool:
        """Run the event loop until everything is solved and reported; returns False after ``timeout`` seconds."""
        end = time.monotonic() + timeout
        while self._kernels.is_pending or self._turn.isActive() or self._rest.isActive() or self._works:
            if time.monotonic() > end:
                return False
            QCoreApplication.processEvents()
            time.sleep(0.0005)
        if self._telling.isActive():
            self._telling.stop()
            self._tell_results()
        return True

    @property
    def _works(self) -> bool:
        return self._scheduler.busy or self._beside.busy

    def close(self) -> None:
        """Stop the timers, drop all requests, and wait for the workers."""
        for timer in (self._turn, self._rest, self._telling):
            timer.stop()
        self._hand.set_listening(False)
        self.play.close()
        self._document.entity_changed.disconnect(self._schedule)
        self._document.project_opened.disconnect(self._begin_anew)
        self._scheduler.failed.disconnect(self._tell)  # workers wait for the kernels, and are told to give up
        self._kernels.close()
        self._beside.close()
        self._scheduler.close()

    def _play_changed(self, running: bool) -> None:
        """Pause solving during live play, whose worker solves the frames; resume it afterwards."""
        if not running:
            self._schedule("performers", "")

    def _schedule(self, _collection: str, _entity_id: str) -> None:
        self._changed_at = self._hand.moved_at
        if self.play.running:
            return
        if self._interactive:
            self._rest.begin()
        if not self._turn.isActive():
            self._turn.start(WINDOW_MILLISECONDS if self._interactive else 0)

    def _begin_anew(self) -> None:
        together = (_TOGETHER.join(cycle) for cycle in self._circles)
        for key in (*together, *(_SOURCE + motion_id for motion_id in self._sources)):
            self._scheduler.forget(key)
        self._beside.forget(_FRAMES)
        for held in (
            self._wanted, self._results, self._answered, self._told, self._sources, self._asked_at, self._failures,
        ):  # fmt: skip
            held.clear()
        self._frames.clear()
        self._unfinished.clear()
        self._prepare.retain_only(self._document.project.captures.values())
        self._standing.forget()
        self._works_on_former = self._scheduler.busy
        forget_project()
        self._refresh(whole=True)

    def _refresh(self, whole: bool) -> None:
        """Request solves for all that has changed: of ``whole`` motions, or of windows during a drag."""
        project = self._document.project
        cycles = _cycles_of(project)
        self._leaders = {leader for cycle in cycles for key in cycle for leader in leaders_of(project, key) - {*cycle}}
        for key in self._wanted.keys() - {key for cycle in cycles for key in cycle}:
            for held in (self._wanted, self._results, self._answered, self._asked_at, self._failures):
                held.pop(key, None)
            self._frames.drop_frame(key)
        for cycle in self._circles - {*cycles}:
            self._scheduler.forget(_TOGETHER.join(cycle))
        self._circles, self._unfinished = {*cycles}, self._unfinished & {*cycles}
        for cycle in sorted(cycles, key=lambda cycle: not self._selected(cycle)):  # first who is worked on
            self._request(cycle, whole)
        self._tell_busy()

    def _request(self, cycle: tuple[str, ...], whole: bool) -> None:
        project = self._document.project
        wanted = {key: body_request_of(project, key, cycle, self._results.get) for key in cycle}
        known = {key: each for key, each in wanted.items() if each is not None}
        same = all(self._wanted.get(key) == each for key, each in known.items())
        if len(known) < len(cycle) or (same and not (whole and cycle in self._unfinished)):
            return
        if not same:
            self._wanted |= known
        if not self._kernels.can_solve(project, cycle):
            self._unfinished.add(cycle)  # until the kernels are there
            return
        known = {key: self._wanted[key] for key in cycle}
        stages = self._stages(project, cycle, known, whole)
        if stages:
            self._report_soon()
            self._scheduler.request(_TOGETHER.join(cycle), self._document.revision, *stages)

    def _stages(
        self, project: Project, cycle: tuple[str, ...], wanted: Mapping[str, BodyRequest], whole: bool
    ) -> tuple[Callable[[], SolveResults], ...]:
        """Stages of a solve: one for all frames if ``whole``; during a drag, one for the frames around the playhead,
        unsmoothed, or none if the solve must wait for the end of the drag.
        """
        asked_at, base = self._changed_at, self._results.get(cycle[0])
        if whole or base is None or not _fits(base, wanted[cycle[0]], project):
            self._unfinished.discard(cycle)
            return (lambda: self._solved(project, wanted, asked_at, 0, None),)
        self._unfinished.add(cycle)
        stands = wanted[cycle[0]].has_same_grounding(self._answered.get(cycle[0]))
        if len(cycle) > 1 or not stands or not self._selected(cycle):
            return ()  # what costs most with every move, and who is not worked on, waits for the hand to rest
        first, last = self._window(project, wanted[cycle[0]].performer)
        exact = {key: replace(each, eased=False) for key, each in wanted.items()}

        def window() -> SolveResults:
            solved = self._solved(project, exact, asked_at, first, last)
            return replace(solved, adapted={cycle[0]: with_window_merged(base, solved.adapted[cycle[0]])})

        return (window,)

    def _prepared(self, capture: Capture) -> tuple[NormalizedMotion, Morphology]:
        """Normalised motion of a capture and morphology of its actor, for a worker, which waits for the kernels."""
        self._kernels.join_grounded()
        return self._prepare(capture)

    def _realised(self, capture: Capture) -> AdaptedMotion:
        return self._realise(*self._prepared(capture))

    def _solved(
        self, project: Project, wanted: Mapping[str, BodyRequest], asked_at: float, first: int, last: int | None
    ) -> SolveResults:
        players = {key: player_of(project, key, each, self._prepare) for key, each in wanted.items()}
        if len(players) == 1:
            [(key, player)] = players.items()
            answers: Mapping[str, AdaptedMotion] = {key: self._solve(player.request, first, last)}
        else:
            answers = solve_cycle(players, lambda _, request: self._solve(request, 0, None)).results
        adapted = {key: replace(answer, composite=players[key].composite) for key, answer in answers.items()}
        return SolveResults(adapted, wanted, asked_at, last is None)

    def _window(self, project: Project, performer: Performer) -> tuple[int, int]:
        """First and last frame of a performer's motion within ``WINDOW_SECONDS`` of the playhead."""
        timing = timing_of(project, performer)
        frame = round(timing.frame_at(self._document.playhead.time))
        reach = round(WINDOW_SECONDS * timing.frame_rate)
        return max(frame - reach, 0), frame + reach

    def _take(self, key: str, _revision: int, answer: SolveResults | AdaptedMotion) -> None:
        if key.startswith(_EXPECTED):
            return
        if isinstance(answer, SolveResults):
            self._report_soon()
            for performer_id, adapted in answer.adapted.items():
                self._results[performer_id], self._asked_at[performer_id] = adapted, answer.asked_at
                self._failures.pop(performer_id, None)
                if answer.whole:
                    self._answered[performer_id] = answer.wanted[performer_id]
                    self._frames.note_whole_motion(performer_id, answer.asked_at)
                self.adapted.emit(performer_id)
                if performer_id in self._leaders:
                    self._schedule("performers", performer_id)
            return
        motion_id = key.removeprefix(_SOURCE)
        self._sources[motion_id] = (self._sources[motion_id][0], answer)
        for performer_id, performer in self._document.project.performers.items():
            if any(clip.motion_id == motion_id for clip in performer.clips):
                self.adapted.emit(performer_id)

    def _take_frames(self, _key: str, _revision: int, outcomes: Sequence[FrameResult]) -> None:
        there = [outcome for outcome in outcomes if outcome.cycle in self._circles]
        for performer_id in self._frames.take(there):
            self.adapted.emit(performer_id)

    def _tell(self, key: str, _revision: int, error: Exception) -> None:
        if key.startswith(_EXPECTED):
            return  # it comes again when the capture is shown
        if not isinstance(error, StudioError):
            raise error
        for performer_id in key.split(_TOGETHER) if not key.startswith(_SOURCE) else ():
            self._failures[performer_id] = str(error)
            self._results.pop(performer_id, None)  # what it played before is not what is asked
            self.adapted.emit(performer_id)
        self._document.problem_reported.emit(str(error))
        self._report_soon()

    def _tell_busy(self) -> None:
        busy = self._scheduler.busy
        if self._works_on_former and not busy:  # what was under way as another project was opened filled caches again
            self._works_on_former = False
            forget_project()
        waiting = self._interactive or self._turn.isActive() or self._rest.isActive()
        if not busy and self._telling.isActive() and not waiting:
            self._telling.start(0)  # there is no more to come
        if busy != self._busy:
            self._busy = busy
            self.busy_changed.emit(busy)


def _raise(_key: str, _revision: int, error: Exception) -> None:
    raise error


def _cycles_of(project: Project) -> tuple[tuple[str, ...], ...]:
    """Cycles of all performers that play on the stage, leaders first."""
    playing = [
        key
        for key, item in project.performers.items()
        if item.visible and item.clips and not project.missing_references(item)
    ]
    return leaders_first(project, playing)


def with_window_merged(whole: AdaptedMotion, window: AdaptedMotion) -> AdaptedMotion:
    """``whole`` with the frames of ``window`` replaced; both have the same constraints and layout."""
    frames = slice(window.first_frame, window.first_frame + window.frame_count)
    arrays = {name: getattr(whole, name).copy() for name in ("positions", "rotations", "residuals")}
    arrays["positions"][frames] = window.positions[:]
    arrays["rotations"][frames] = window.rotations[:]
    arrays["residuals"][:, frames] = window.residuals
    body = {name: getattr(window, name) for name in ("morphology", "animated", "volume", "unconstrained")}
    return replace(whole, **body, **arrays)


def _fits(whole: AdaptedMotion, wanted: BodyRequest, project: Project) -> bool:
    return (
        whole.frame_count == frame_count_of(project, wanted.performer)
        and len(whole.residuals) == len(wanted.constraints)
        and whole.morphology.layout == wanted.morphology.layout
    )
