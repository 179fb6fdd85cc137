"""A picture of a dragged body shows its frame for the present request, as the whole clip has it."""

import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.scope import Scope
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.stage.project import GROUND_ID
from studio.document.document import Document
from studio.engine.frames import EDITED_FRAME_BUDGET_SECONDS, PIECE_FRAMES
from studio.engine.live_adaptation import LiveAdaptation, normalized_with_actor
from studio.engine.standing_solver import GroundingSolver
from tests.builders import make_constraint, make_project
from tests.patience import SECONDS

FRAMES, FRAME = 60, 15
KEPT, MET = 1e-6, 0.002
"""Metres: poses are kept in 32 bits; those who meet are at rest from sweep to sweep."""


@pytest.fixture
def live(qapp: Any) -> Iterator[LiveAdaptation]:
    document = Document(make_project(characters=2, frames=FRAMES))
    document.playhead.set_frame(FRAME)
    live = LiveAdaptation(document)
    live.document = document  # type: ignore[attr-defined]
    assert live.wait_until_solved(SECONDS)
    live.interactive = True
    yield live
    live.close()


def drag(document: Document, place: tuple[float, float, float]) -> None:
    asked = document.project.constraints["constraint 0"]
    document.replace("constraints", "constraint 0", replace(asked, target=place), "Drag", 1)


def exact(document: Document, performer_id: str) -> Any:
    """(P, 3) the frame at the playhead out of the whole clip, solved without a window."""
    solved = adapt_performers(
        document.project, [performer_id], normalized_with_actor, lambda request: adapt(replace(request, eased=False))
    )
    motion = solved.performances[performer_id].adapted
    return motion.positions[FRAME]


def let_others_follow(live: Any) -> None:
    """Until what is asked of who is worked on is answered by the others too."""
    end = time.monotonic() + SECONDS
    asked_at = live.asked_at(live.document.active_performer_id)
    while any(live.asked_at(key) < asked_at for key in live.document.project.performers):
        QApplication.processEvents()
        assert time.monotonic() < end


def shown(live: LiveAdaptation, performer_id: str) -> Any:
    motion = live.shown_frame(performer_id)
    assert motion is not None
    return motion.positions[FRAME - motion.first_frame]


@pytest.mark.parametrize(("late", "told"), [(0.2, 0.2), (1000.0, 0.0)])
def test_a_pose_is_as_old_as_the_move_of_the_mouse_that_it_answers(live: Any, late: float, told: float) -> None:
    """However late the window takes the move; an event whose time cannot be is taken as of now."""
    place, none = QPointF(5.0, 5.0), Qt.KeyboardModifier.NoModifier
    left = Qt.MouseButton.LeftButton
    event = QMouseEvent(QEvent.Type.MouseMove, place, place, Qt.MouseButton.NoButton, left, none)
    moved = time.monotonic()
    event.setTimestamp(round(1000 * (moved - late)))
    widget = QWidget()
    QApplication.sendEvent(widget, event)
    drag(live.document, (0.4, 0.1, 1.2))
    live.solve_frame(live.document.playhead.time)
    active = live.document.active_performer_id
    assert moved - told - 0.001 <= live.asked_at(active) <= time.monotonic() - told


def test_every_move_is_shown_at_once_as_the_whole_clip_has_that_frame(live: Any) -> None:
    """On the body that is worked on; the others follow while that picture is drawn."""
    active = live.document.active_performer_id
    for step in range(5):
        drag(live.document, (0.4, 0.1 * step, 1.2))
        live.solve_frame(live.document.playhead.time)
        np.testing.assert_allclose(shown(live, active), exact(live.document, active), atol=KEPT)
        let_others_follow(live)
        for key in live.document.project.performers:
            np.testing.assert_allclose(shown(live, key), exact(live.document, key), atol=KEPT)
            assert not live.is_eased(key)


def test_what_was_shown_last_is_what_is_there_after_release_but_for_the_easing(live: Any) -> None:
    drag(live.document, (0.4, 0.2, 1.2))
    live.solve_frame(live.document.playhead.time)
    last = shown(live, "performer 0")
    live.interactive = False
    assert live.wait_until_solved(SECONDS)
    live.solve_frame(live.document.playhead.time)
    assert live.is_eased("performer 0")
    assert live.shown_frame("performer 0") is live.result("performer 0")
    np.testing.assert_allclose(shown(live, "performer 0"), last, atol=0.005)


def test_a_body_whose_measures_are_dragged_follows_in_the_same_picture(live: Any) -> None:
    document = live.document
    character = document.project.characters["character 1"]
    taller = replace(character, proportions=replace(character.proportions, stature=1.2))
    document.replace("characters", "character 1", taller, "Grow", 1)
    live.solve_frame(document.playhead.time)
    np.testing.assert_allclose(shown(live, "performer 1"), exact(document, "performer 1"), atol=KEPT)
    assert live.shown_frame("performer 0") is live.result("performer 0")  # whom it does not concern


def test_the_ground_that_is_dragged_carries_every_body_by_the_next_picture(live: Any) -> None:
    document = live.document
    document.replace("grounds", GROUND_ID, replace(document.project.ground, height=0.3), "Raise ground", 1)
    live.solve_frame(document.playhead.time)
    let_others_follow(live)
    for key in document.project.performers:
        np.testing.assert_allclose(shown(live, key), exact(document, key), atol=KEPT)


def test_who_is_followed_and_who_follows_are_shown_at_one_moment(live: Any) -> None:
    document = live.document
    document.replace(
        "constraints", "constraint 0",
        replace(document.project.constraints["constraint 0"], scope=Scope(performer_id="performer 1")), "One",
    )  # fmt: skip
    # Arms that come out of their body do so over time: those of who follows, by where the other was till now.
    document.replace("performers", "performer 0", replace(document.project.performers["performer 0"], clears=False), "")
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    follower = make_constraint(name="after it", target=FollowPerformer("performer 1", wrist))
    document.add("constraints", replace(follower, scope=Scope(performer_id="performer 0")), "Follow")
    live.interactive = False
    assert live.wait_until_solved(SECONDS)
    live.interactive = True
    document.selection.set(("performers", "performer 0"))
    before = shown(live, "performer 0")
    drag(document, (0.5, 0.3, 1.1))
    live.solve_frame(document.playhead.time)
    assert np.abs(shown(live, "performer 0") - before).max() > 0.001
    np.testing.assert_allclose(shown(live, "performer 0"), exact(document, "performer 0"), atol=KEPT)


def test_who_follow_each_other_follow_the_hand_together_in_the_same_picture(live: Any) -> None:
    document, wrist = live.document, BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    document.remove("constraints", "constraint 0", "Nothing else")
    for one, other in (("performer 0", "performer 1"), ("performer 1", "performer 0")):
        meets = make_constraint(name=f"meets {other}", target=FollowPerformer(other, wrist))
        document.add("constraints", replace(meets, scope=Scope(performer_id=one)), "Meet")
    live.interactive = False
    assert live.wait_until_solved(SECONDS)
    live.interactive = True
    document.selection.set(("performers", "performer 0"))
    before = {key: shown(live, key) for key in document.project.performers}
    place = replace(document.project.performers["performer 0"], position=(0.3, 0.1))
    document.replace("performers", "performer 0", place, "Drag", 1)
    live.solve_frame(document.playhead.time)
    for key in before:
        assert np.abs(shown(live, key) - before[key]).max() > 0.001
        np.testing.assert_allclose(shown(live, key), exact(document, key), atol=MET)


def test_another_moment_is_solved_for_itself(live: Any) -> None:
    drag(live.document, (0.4, 0.2, 1.2))
    for frame in (FRAME, 0, FRAMES - 1, 10 * FRAMES):
        live.solve_frame(frame / 60.0)
        assert live.shown_frame("performer 0").first_frame == min(frame, FRAMES - 1)


def test_a_frame_that_costs_long_keeps_no_picture_waiting_but_the_first(qapp: Any) -> None:
    solver, solved = GroundingSolver(), []

    def slow(request: Any, first: int, last: int | None) -> Any:
        begun = time.thread_time()
        while last is not None and time.thread_time() - begun < 2 * EDITED_FRAME_BUDGET_SECONDS:
            pass
        solved.append(threading.current_thread() is threading.main_thread())
        return solver(request, first, last)

    document = Document(make_project(characters=1, frames=FRAMES))
    live: Any = LiveAdaptation(document, solve=slow)
    live.document = document
    assert live.wait_until_solved(SECONDS)
    solved.clear()
    live.interactive = True
    for step in range(4):
        drag(document, (0.4, 0.1 * step, 1.2))
        live.solve_frame(0.0)
    let_others_follow(live)
    assert solved.count(True) == 1
    live.interactive = False
    assert live.wait_until_solved(SECONDS)
    assert live.shown_frame("performer 0") is live.result("performer 0")
    live.close()


@pytest.mark.parametrize("repeats", [1, 60], ids=["many frames", "many pieces"])
def test_a_row_that_is_very_long_keeps_not_even_the_first_picture_waiting(
    live: Any, monkeypatch: Any, repeats: int
) -> None:
    """Clips an hour apart hold a pose between them that stands in every frame; one that plays again is joined."""
    document, performer = live.document, live.document.project.performers["performer 0"]
    if repeats == 1:
        monkeypatch.setattr("studio.engine.frames.MANY_FRAMES", FRAMES - 1 + PIECE_FRAMES)
    row = (replace(performer.clips[0], repeats=repeats),)
    document.replace("performers", "performer 0", replace(performer, clips=row), "Play again")
    assert live.wait_until_solved(SECONDS)
    live.solve_frame(document.playhead.time)
    before = shown(live, "performer 0").copy()
    drag(document, (0.4, 0.1, 1.2))
    live.solve_frame(document.playhead.time)
    assert np.array_equal(shown(live, "performer 0"), before)
    end = time.monotonic() + SECONDS
    while np.array_equal(shown(live, "performer 0"), before) and time.monotonic() < end:
        QApplication.processEvents()
    assert not np.array_equal(shown(live, "performer 0"), before)
