"""Every visible performer follows the document; a drag sees its window first; nothing is solved twice."""

import gc
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtCore import QTimer
from PySide6.QtTest import QTest

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.constraints.scope import Scope
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.mesh.volume import BodyVolume, fitted_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.project import GROUND_ID
from studio.document.document import Document
from studio.engine.live_adaptation import DRAG_REPORT_MILLISECONDS, LiveAdaptation
from studio.engine.residuals import unsolved_words
from studio.startup.kernel_warm_up import WarmUp
from tests.builders import make_capture, make_constraint, make_morphology, make_project
from tests.patience import SECONDS

FRAMES = 400


@dataclass
class Solver:
    """Stands for normaliser and solver: a result's positions are all the ground's height, or what else is ``told``."""

    windows: list[tuple[int, int | None]] = field(default_factory=list)
    prepared: list[Capture] = field(default_factory=list)
    hold: threading.Event = field(default_factory=threading.Event)
    told: Callable[[AdaptRequest], float] = lambda request: request.ground.height

    def prepare(self, capture: Capture) -> tuple[NormalizedMotion, Morphology]:
        self.prepared.append(capture)
        if capture.body_map is None:
            raise StudioError(f"'{capture.name}' has no body map.")
        channels = np.zeros((capture.frame_count, 89 + 4 * 3))
        return NormalizedMotion(
            capture.name, capture.frame_rate, channels, np.array([0.0, 0.5, 1.0])
        ), make_morphology()

    def solve(self, request: AdaptRequest, first: int, last: int | None) -> AdaptedMotion:
        self.hold.wait()
        self.windows.append((first, last))
        count = request.motion.frame_count if last is None else last + 1 - first
        body, height = request.morphology, self.told(request)
        return AdaptedMotion(
            body,
            request.motion.frame_rate,
            first,
            np.full((count, body.layout.point_count, 3), height),
            np.zeros((count, body.layout.segment_count, 3, 3)),
            np.full((len(request.constraints), count), height),
        )

    def realise(self, motion: NormalizedMotion, actor: Morphology) -> AdaptedMotion:
        return self.solve(AdaptRequest(motion, actor), 0, None)


@dataclass
class Scene:
    document: Document
    live: LiveAdaptation
    solver: Solver

    def raise_ground(self, height: float) -> None:
        self.document.replace("grounds", GROUND_ID, Ground(height), "Raise ground")

    def heights(self, performer_id: str) -> Any:
        result = self.live.result(performer_id)
        assert result is not None
        return result.positions[:, 0, 0]


@pytest.fixture
def make_scene(qapp: Any) -> Iterator[Callable[..., Scene]]:
    scenes = []

    def make(**parts: Any) -> Scene:
        solver = Solver()
        solver.hold.set()
        document = Document(make_project(frames=FRAMES, **parts))
        live = LiveAdaptation(document, solver.prepare, solver.solve, solver.realise, workers=1)
        scenes.append(live)
        return Scene(document, live, solver)

    yield make
    for live in scenes:
        live.close()
        assert not any(timer.isActive() for timer in live.findChildren(QTimer))
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("solve-")]


def test_every_visible_performer_gets_a_result(make_scene: Any) -> None:
    scene = make_scene(characters=3)
    assert scene.live.wait_until_solved()
    for key in scene.document.project.performers:
        assert scene.live.result(key).frame_count == FRAMES
    assert scene.live.result("performer 1").morphology == scene.document.project.characters["character 1"].morphology
    before = time.monotonic()
    assert scene.live.asked_at("performer 1") < before
    scene.raise_ground(0.1)
    assert scene.live.wait_until_solved()
    assert before < scene.live.asked_at("performer 1") < time.monotonic()


def test_volumes_of_bodies_are_measured_beside_the_window_as_a_project_opens(
    make_scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured = list[threading.Thread]()

    def noted(*skin: Any) -> BodyVolume:
        measured.append(threading.current_thread())
        return fitted_volume(*skin)

    monkeypatch.setattr("studio.engine.body_request.fitted_volume", noted)
    scene = make_scene(characters=2)
    scene.document.new(make_project(characters=5, frames=FRAMES))
    assert scene.live.wait_until_solved()
    assert len(measured) >= 5
    assert threading.main_thread() not in measured


def test_a_capture_is_normalised_once_for_all_performers_and_edits(make_scene: Any) -> None:
    scene = make_scene(characters=4)
    scene.raise_ground(0.1)
    assert scene.live.wait_until_solved()
    assert len(scene.solver.prepared) == 1


def test_a_capture_that_is_expected_is_normalised_before_it_is_shown(make_scene: Any) -> None:
    scene = make_scene()
    assert scene.live.wait_until_solved()
    coming = make_capture(frames=50)
    scene.live.prefetch_capture(coming)
    assert scene.live.wait_until_solved()
    assert scene.solver.prepared[-1] is coming
    before = len(scene.solver.prepared)
    motion_id = next(iter(scene.document.project.motions))
    motion = scene.document.project.motions[motion_id]
    capture_id = scene.document.add("captures", coming, "Import")
    scene.document.replace("motions", motion_id, replace(motion, capture_id=capture_id), "Import")
    assert scene.live.wait_until_solved()
    assert len(scene.solver.prepared) == before


def test_a_change_is_followed_by_those_it_concerns_only(make_scene: Any) -> None:
    scene = make_scene(characters=2)
    scene.live.wait_until_solved()
    heard: list[str] = []
    scene.live.adapted.connect(heard.append)
    character = scene.document.project.characters["character 1"]
    taller = replace(character, proportions=replace(character.proportions, stature=1.1))
    scene.document.replace("characters", "character 1", taller, "Grow")
    scene.live.wait_until_solved()
    assert heard == ["performer 1"]
    scene.document.replace("characters", "character 1", replace(taller, colour="#ffffff"), "Paint")
    scene.live.wait_until_solved()
    assert heard == ["performer 1"]


def test_the_selected_body_is_solved_before_the_others(make_scene: Any) -> None:
    scene = make_scene(characters=4)
    scene.live.wait_until_solved()
    heard: list[str] = []
    scene.live.adapted.connect(heard.append)
    scene.document.selection.set(("performers", "performer 2"))
    scene.raise_ground(0.1)
    scene.live.wait_until_solved()
    assert heard[0] == "performer 2"
    assert sorted(heard[1:]) == ["performer 0", "performer 1", "performer 3"]


def test_several_changes_in_one_turn_ask_for_one_solve(make_scene: Any) -> None:
    scene = make_scene(characters=1)
    scene.live.wait_until_solved()
    scene.solver.windows.clear()
    with scene.document.group("Many"):
        for k in range(5):
            scene.document.add("constraints", make_constraint(name=f"T{k}", priority=k + 1), "Add")
    scene.live.wait_until_solved()
    assert scene.solver.windows == [(0, None)]
    assert len(scene.live.result("performer 0").residuals) == 6


def test_constraints_that_are_off_are_not_asked_for(make_scene: Any) -> None:
    scene = make_scene(characters=1, constraints=2)
    off = replace(scene.document.project.constraints["constraint 0"], enabled=False)
    scene.document.replace("constraints", "constraint 0", off, "Switch off")
    scene.live.wait_until_solved()
    assert len(scene.live.result("performer 0").residuals) == 1


def test_a_drag_solves_a_window_round_the_playhead_first_and_the_rest_after(make_scene: Any) -> None:
    scene = make_scene(characters=1)
    document, asked = scene.document, scene.document.project.constraints["constraint 0"]
    document.replace("constraints", "constraint 0", replace(asked, target=(0.0, 0.0, 0.0)), "Move")
    scene.solver.told = lambda request: request.constraints[0].target[2]
    scene.live.wait_until_solved()
    scene.solver.windows.clear()
    scene.document.playhead.set_frame(200)
    shown: list[Any] = []
    scene.live.adapted.connect(lambda key: shown.append(scene.heights(key).copy()))
    scene.live.interactive = True
    document.replace("constraints", "constraint 0", replace(asked, target=(0.0, 0.0, 0.2)), "Move")
    scene.live.wait_until_solved()
    assert scene.solver.windows == [(155, 245), (0, None)]
    window, whole = shown
    assert (window[155:246] == 0.2).all()
    assert (window[:155] == 0.0).all()
    assert (window[246:] == 0.0).all()
    assert (whole == 0.2).all()


def test_while_the_ground_is_dragged_no_more_is_solved_than_pictures_need_until_the_hand_rests(make_scene: Any) -> None:
    scene = make_scene(characters=1)
    scene.live.wait_until_solved()
    scene.solver.windows.clear()
    scene.live.interactive = True
    for step in range(1, 5):
        scene.raise_ground(step / 100)
        assert scene.live.wait_until_solved(0.05) is False
    assert scene.solver.windows == []
    assert scene.live.wait_until_solved()
    assert scene.solver.windows == [(0, None)]


def test_during_a_drag_the_newest_edit_wins_and_the_last_is_solved_whole(make_scene: Any) -> None:
    scene = make_scene(characters=3)
    scene.live.wait_until_solved()
    scene.live.interactive = True
    scene.solver.hold.clear()
    for step in range(1, 30):
        scene.raise_ground(step / 100)
        scene.live.wait_until_solved(0.001)
    scene.solver.hold.set()
    scene.live.interactive = False
    scene.live.wait_until_solved()
    for key in scene.document.project.performers:
        assert (scene.heights(key) == 0.29).all()
    assert len(scene.solver.windows) < 30


def test_what_is_asked_anew_is_not_told_of_before_it_is_solved(make_scene: Any) -> None:
    scene = make_scene(characters=2)
    scene.live.wait_until_solved()
    assert scene.live.reported_motion("performer 0") is scene.live.result("performer 0")
    scene.solver.hold.clear()
    document, asked = scene.document, scene.document.project.constraints["constraint 0"]
    document.replace("constraints", "constraint 0", replace(asked, target=(9.0, 9.0, 9.0)), "Move target")
    assert scene.live.reported_motion("performer 0") is None  # at once, before the engine has had its turn
    scene.live.wait_until_solved(0.3)
    assert scene.live.reported_motion("performer 0") is None
    assert scene.live.result("performer 0") is not None  # the old pose stays on show
    scene.solver.hold.set()
    scene.live.wait_until_solved()
    assert scene.live.reported_motion("performer 0") is scene.live.result("performer 0")
    document.replace("performers", "performer 0", replace(document.project.performers["performer 0"], name="X"), "X")
    assert scene.live.reported_motion("performer 0") is not None  # a name asks nothing


def test_all_views_are_told_of_one_answer_at_one_moment(make_scene: Any) -> None:
    scene = make_scene(characters=1)
    scene.live.wait_until_solved()
    before = scene.live.reported_motion("performer 0")
    scene.live.interactive = True
    scene.raise_ground(0.2)
    told = [before]
    heard: list[bool] = []
    scene.live.adapted.connect(lambda key: heard.append(scene.live.reported_motion(key) is told[-1]))
    scene.live.reported_changed.connect(lambda: told.append(scene.live.reported_motion("performer 0")))
    scene.live.wait_until_solved()
    assert all(heard)  # a newer pose; what is told of the constraints changes for all views together
    assert told[-1] is scene.live.result("performer 0")


def test_a_drag_is_reported_four_times_a_second_and_its_end_at_once(make_scene: Any) -> None:
    """Whenever the workers rested, each answer was reported at once: forms, strips and plots were painted for each."""
    scene = make_scene(characters=1, constraints=1)
    document, live = scene.document, scene.live
    document.selection.set(("performers", "performer 0"))
    live.wait_until_solved()
    [(key, constraint)] = document.project.constraints.items()
    told: list[float] = []
    live.reported_changed.connect(lambda: told.append(time.monotonic()))
    live.interactive = True
    begun = time.monotonic()
    while time.monotonic() < begun + 1.0:
        document.replace("constraints", key, replace(constraint, target=(time.monotonic() - begun, 0.0, 1.0)), "Move")
        QTest.qWait(10)
    assert len(scene.solver.windows) > 4  # the worker answers more often
    assert 2 <= len(told) <= 1000 / DRAG_REPORT_MILLISECONDS
    live.interactive = False
    live.wait_until_solved()
    assert live.reported_motion("performer 0") is live.result("performer 0")


def test_a_hidden_performer_is_not_solved(make_scene: Any) -> None:
    scene = make_scene(characters=2)
    scene.live.wait_until_solved()
    hidden = replace(scene.document.project.performers["performer 0"], visible=False)
    scene.document.replace("performers", "performer 0", hidden, "Hide")
    scene.live.wait_until_solved()
    assert scene.live.result("performer 0") is None
    scene.document.undo_stack.undo()
    scene.live.wait_until_solved()
    assert scene.live.result("performer 0") is not None


def test_another_project_takes_the_place_of_all_results(make_scene: Any) -> None:
    scene = make_scene(characters=3)
    scene.live.wait_until_solved()
    scene.document.new(make_project(characters=1, frames=20))
    scene.live.wait_until_solved()
    assert scene.live.result("performer 2") is None
    assert scene.live.result("performer 0").frame_count == 20


def test_the_source_is_the_capture_on_its_actors_body(make_scene: Any) -> None:
    scene = make_scene(characters=2)
    scene.live.wait_until_solved()
    heard: list[str] = []
    scene.live.adapted.connect(heard.append)
    assert scene.live.source("motion") is None
    scene.live.wait_until_solved()
    assert scene.live.source("motion").frame_count == FRAMES
    assert heard == ["performer 0", "performer 1"]
    assert scene.live.source("no such motion") is None


def test_a_capture_that_cannot_be_normalised_is_told_in_its_sentence(make_scene: Any) -> None:
    scene = make_scene(characters=1)
    told: list[str] = []
    scene.document.problem_reported.connect(told.append)
    scene.document.replace("captures", "capture", make_capture("lamp", body_map=None), "Replace capture")
    scene.live.wait_until_solved()
    assert told == ["'lamp' has no body map."]


def test_busy_is_told_when_it_begins_and_when_it_ends(make_scene: Any) -> None:
    scene = make_scene(characters=2)
    scene.live.wait_until_solved()
    heard: list[bool] = []
    scene.live.busy_changed.connect(heard.append)
    scene.raise_ground(0.3)
    scene.live.wait_until_solved()
    assert heard == [True, False]


def test_the_real_solver_answers_for_every_performer(qapp: Any) -> None:
    document = Document(make_project(characters=2, frames=60))
    live = LiveAdaptation(document)
    assert live.wait_until_solved(SECONDS)
    live.source("motion")
    assert live.wait_until_solved(SECONDS)
    results = [live.result("performer 0"), live.result("performer 1"), live.source("motion")]
    live.close()
    assert all(np.isfinite(result.positions).all() and result.frame_count == 60 for result in results)


def test_motions_of_projects_that_are_gone_are_let_go(qapp: Any) -> None:
    document = Document()
    live = LiveAdaptation(document)
    opened: list[weakref.ref[Any]] = []
    for frames in range(20, 40):
        document.new(make_project(characters=1, frames=frames))
        assert live.wait_until_solved(SECONDS)
        opened += [weakref.ref(live.motion("motion")), weakref.ref(document.project.captures["capture"])]
    gc.collect()
    assert sum(each() is not None for each in opened) < 20  # of 40: workers and small caches hold their last few
    live.close()


def test_closing_while_kernels_are_still_compiled_waits_for_none_and_tells_nothing(qapp: Any) -> None:
    class Warming:
        """Kernels that are never there."""

        grounded = ready = False
        stopped, asked = threading.Event(), threading.Event()

        def join_grounded(self) -> None:
            self.asked.set()
            self.stopped.wait()
            raise CancelledError

        def stop(self, _patience: float) -> None:
            self.stopped.set()
            time.sleep(0.05)  # the worker that waited goes on

    solver, document, warming = Solver(), Document(), Warming()
    live = LiveAdaptation(document, solver.prepare, solver.solve, solver.realise, warm_up=cast(WarmUp, warming))
    document.new(make_project())
    live.wait_until_solved(0.01)
    live.source("motion")
    assert warming.asked.wait(SECONDS)
    live.close()
    qapp.processEvents()
    assert solver.windows == []


def test_what_is_known_is_shown_until_the_kernels_are_there(qapp: Any) -> None:
    solver, document = Solver(), Document()
    kernels = SimpleNamespace(grounded=False, ready=False, stop=lambda _patience: None)
    live = LiveAdaptation(document, solver.prepare, solver.solve, solver.realise, warm_up=cast(WarmUp, kernels))
    solver.hold.set()
    document.new(project := make_project())
    key = next(iter(project.performers))
    positions, rotations = np.zeros((2, 1, 3)), np.zeros((2, 1, 3, 3))
    known = AdaptedMotion(make_morphology(), 60.0, 0, positions, rotations, np.empty((0, 2)))
    live.show_until_solved({key: known, "nobody": known})
    live.wait_until_solved(0.05)
    assert live.result(key) is known
    assert live.result("nobody") is None
    kernels.grounded = kernels.ready = True
    assert live.wait_until_solved()
    assert live.result(key) is not known
    live.close()


def test_bodies_stand_while_the_kernels_of_constraints_are_still_compiled(qapp: Any) -> None:
    """Bodies with a constraint, or that get one, wait for them, and the words say so."""
    solver, document = Solver(), Document(make_project(constraints=0))
    solver.hold.set()
    kernels = SimpleNamespace(grounded=True, ready=False, stop=lambda _patience: None)
    live = LiveAdaptation(document, solver.prepare, solver.solve, solver.realise, warm_up=cast(WarmUp, kernels))
    live.wait_until_solved(0.5)
    assert live.reported_motion("performer 0") is live.result("performer 0") is not None
    document.replace("grounds", GROUND_ID, Ground(0.2), "Raise ground")
    live.solve_frame(0.0)
    assert live.shown_frame("performer 0").positions[0, 0, 0] == 0.2  # type: ignore[union-attr]
    live.wait_until_solved(0.5)
    solved, known = len(solver.windows), live.result("performer 0")
    document.add("constraints", replace(make_constraint(), scope=Scope(performer_id="performer 0")), "Reach")
    live.solve_frame(0.0)
    live.wait_until_solved(0.5)
    assert (len(solver.windows), live.result("performer 0")) == (solved, known)
    assert live.reported_motion("performer 0") is None
    assert live.reported_motion("performer 1") is not None
    assert unsolved_words(live) == "waits for the solver"
    kernels.ready = True
    assert live.wait_until_solved()
    assert live.reported_motion("performer 0") is live.result("performer 0") is not known
    assert unsolved_words(live) == "not solved yet"
    live.close()
