"""A drag on a slow machine: pictures come seldomer, but the body under the hand is in each, and nobody is left behind.

The solver burns more processor time than it needs. Ages are counted in pictures and in turns of the worker.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest
from PySide6.QtWidgets import QApplication

from studio.document.document import Document
from studio.engine import frames
from studio.engine.frames import FRAME_BUDGET_SECONDS
from studio.engine.live_adaptation import LiveAdaptation
from studio.engine.mouse_timestamps import BUSY_DELAY_SECONDS, RestTimer
from studio.engine.standing_solver import GroundingSolver
from tests.builders import make_project
from tests.patience import SECONDS

BODIES, PICTURES = 5, 8
LONG_SECONDS = 0.08
"""In place of ``frames.EDITED_FRAME_BUDGET_SECONDS``, so that less than half of the time is burnt."""
ACTIVE = "performer 0"


class Drag:
    """Five bodies; the stature of one is dragged, a picture for each move. ``burn``: seconds that a frame costs beyond
    the solver's own, by how many frames were solved before."""

    def __init__(self, burn: Callable[[int], float]) -> None:
        self.burn, self.count = burn, 0
        self.solver = GroundingSolver()
        self.document = Document(make_project(characters=BODIES, frames=60))
        self.live = LiveAdaptation(self.document, solve=self.solve)
        assert self.live.wait_until_solved(SECONDS)
        self.count = 0
        self.live.interactive = True

    def solve(self, request: Any, first: int, last: int | None) -> Any:
        end, self.count = time.thread_time() + self.burn(self.count) * (last is not None), self.count + 1
        solved = self.solver(request, first, last)
        while time.thread_time() < end:
            pass
        return solved

    def move(self, character_id: str = "character 0") -> float:
        """The next move of the hand with its picture; when it came."""
        moved_at, character = time.monotonic(), self.document.project.characters[character_id]
        stature = character.proportions.stature + 0.01
        taller = replace(character, proportions=replace(character.proportions, stature=stature))
        self.document.replace("characters", character_id, taller, "Grow", 1)
        self.live.solve_frame(self.document.playhead.time)
        return moved_at

    def let_worker_answer(self) -> None:
        """As long as the picture is drawn, what is solved beside it has time."""
        end = time.monotonic() + SECONDS
        while self.live._beside.busy:
            QApplication.processEvents()
            assert time.monotonic() < end

    def is_fresh(self, performer_id: str, moved_at: float) -> bool:
        """True if the body shown answers the move at ``moved_at``."""
        asked_at = self.live.asked_at(performer_id)
        return asked_at is not None and asked_at >= moved_at


def test_a_hand_does_not_rest_while_the_window_is_too_busy_to_hear_of_it(qapp: Any) -> None:
    """One picture that takes long does not let whole clips be solved in the middle of a drag."""
    told: list[float] = []
    rest = RestTimer(50)
    rest.rested.connect(lambda: told.append(time.monotonic()))
    rest.begin()
    time.sleep(0.05 + 3.0 * BUSY_DELAY_SECONDS)
    busy_until = time.monotonic()
    while not told and time.monotonic() < busy_until + SECONDS:
        QApplication.processEvents()
    assert told[0] >= busy_until + 0.045


@pytest.fixture
def begin(qapp: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Drag]]:
    monkeypatch.setattr(frames, "EDITED_FRAME_BUDGET_SECONDS", LONG_SECONDS)
    drags: list[Drag] = []

    def make(burn: Callable[[int], float]) -> Drag:
        drags.append(Drag(burn))
        return drags[-1]

    yield make
    for drag in drags:
        drag.live.close()


def test_a_body_that_was_slow_once_is_in_every_picture_again(begin: Any) -> None:
    drag = begin(lambda count: 2.0 * LONG_SECONDS if count == 0 else 0.0)
    drag.move()
    drag.move()
    drag.let_worker_answer()
    assert all(drag.is_fresh(ACTIVE, drag.move()) for _ in range(PICTURES))


def test_a_body_that_is_slow_but_not_too_slow_is_in_every_picture(begin: Any) -> None:
    drag = begin(lambda _: 0.5 * LONG_SECONDS)
    assert all(drag.is_fresh(ACTIVE, drag.move()) for _ in range(PICTURES))


def test_a_body_that_is_always_too_slow_is_in_every_turn_of_the_worker(begin: Any) -> None:
    """However many others stand beside, and though nothing has changed about them."""
    drag = begin(lambda _: 1.5 * LONG_SECONDS)
    drag.move()
    for _ in range(PICTURES):
        moved_at = drag.move()
        drag.let_worker_answer()
        assert drag.is_fresh(ACTIVE, moved_at)


def test_whom_a_slow_drag_concerns_too_is_at_most_as_many_turns_behind_as_bodies_are_left(begin: Any) -> None:
    """They play the same character; bodies that the drag does not concern take no turn from them."""
    drag = begin(lambda _: 2.0 * FRAME_BUDGET_SECONDS)
    document, also = drag.document, "performer 3"
    document.replace(
        "performers", also, replace(document.project.performers[also], character_id="character 0"), "Same character"
    )
    drag.live.interactive = False
    assert drag.live.wait_until_solved(SECONDS)
    drag.live.interactive = True
    moves = []
    for _ in range(2 * PICTURES):
        moves.append(drag.move())
        drag.let_worker_answer()
        assert drag.is_fresh(ACTIVE, moves[-1])
        assert len(moves) < BODIES or drag.is_fresh(also, moves[-BODIES])


def test_of_many_selected_bodies_the_active_one_is_in_every_picture(begin: Any) -> None:
    drag = begin(lambda _: 0.7 * LONG_SECONDS)
    document = drag.document
    document.selection.set(*(("performers", key) for key in document.project.performers))
    active = document.active_performer_id
    character_id = document.project.performers[active].character_id
    for performer_id, performer in document.project.performers.items():
        document.replace("performers", performer_id, replace(performer, character_id=character_id), "Same character")
    drag.live.interactive = False
    assert drag.live.wait_until_solved(SECONDS)
    drag.live.interactive = True
    begun = time.thread_time()
    drag.move(character_id)
    first = time.thread_time() - begun
    assert all(drag.is_fresh(active, drag.move(character_id)) for _ in range(PICTURES))
    assert time.thread_time() - begun - first < 1.8 * LONG_SECONDS * PICTURES  # not all of them before each picture


def test_a_body_that_a_drag_does_not_concern_answers_it_as_it_is(begin: Any) -> None:
    """It is not behind, however long ago it was solved."""
    drag = begin(lambda _: 0.0)
    moves = [drag.move("character 1") for _ in range(PICTURES)]
    drag.let_worker_answer()
    assert drag.live.shown_frame(ACTIVE) is drag.live.result(ACTIVE)
    assert drag.is_fresh(ACTIVE, moves[-1])


def test_a_change_that_asks_nothing_new_of_a_body_leaves_no_frame_of_it_behind(begin: Any) -> None:
    """A frame that answers the same as the whole motion gives way to it, whichever was asked later."""
    drag = begin(lambda _: 0.0)
    drag.move()
    drag.live.interactive = False
    QApplication.processEvents()  # the whole motion is asked for
    drag.document.replace(
        "performers", "performer 1", replace(drag.document.project.performers["performer 1"], name="Renamed"), "Rename"
    )
    drag.live.solve_frame(drag.document.playhead.time)
    assert drag.live.wait_until_solved(SECONDS)
    drag.live.solve_frame(drag.document.playhead.time)
    assert drag.live.shown_frame(ACTIVE) is drag.live.result(ACTIVE)
    assert drag.live.is_eased(ACTIVE)


def test_after_release_the_one_body_that_was_dragged_is_solved_once(begin: Any) -> None:
    """So its strips wait for nothing but its own solve, however slow that is."""
    drag = begin(lambda _: 0.5 * LONG_SECONDS)
    for _ in range(PICTURES):
        drag.move()
    drag.let_worker_answer()
    drag.count = 0
    drag.live.interactive = False
    assert drag.live.wait_until_solved(SECONDS)
    assert drag.count == 1
    assert drag.live.reported_motion(ACTIVE) is drag.live.result(ACTIVE)
