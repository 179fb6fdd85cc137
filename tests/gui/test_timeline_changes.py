"""Change from one clip of a row to the next, as it is seen and told on the real widget."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QApplication

from studio.core.normalized.normalize import normalize_capture
from studio.core.solver.performers.rows import composite_of
from studio.core.stage.clip import Clip
from studio.document import colours
from studio.document.document import Document
from studio.timeline.hover import hover_text
from tests.builders import make_project
from tests.gui.hand import RATE, pixels
from tests.timeline.fakes import FakeLive

FIRST, BEFORE = "performer 0", Clip("motion", 0, 60, 0.0, "before")
OVER = Clip("motion", 10, 80, 40 / RATE, "after")


class RowLive(FakeLive):
    """Knows what each row comes to."""

    def __init__(self, document):
        super().__init__(document)
        [capture] = document.project.captures.values()
        self.motion, _ = normalize_capture(capture)

    def result(self, performer_id):
        row = composite_of(self.document.project, performer_id, lambda _: self.motion)
        return replace(super().result(performer_id), composite=row)

    @property
    def takes_over(self):
        """Seconds at which the second clip of the row does."""
        row = self.result(FIRST).composite
        return row.timing.stage_time(row.played[1].first)


@pytest.fixture
def document(qapp):
    """One performer with two clips that overlap."""
    project = make_project(characters=1, constraints=0, contacts=0, frames=101)
    performer = replace(project.performers[FIRST], clips=(BEFORE, OVER))
    document = Document(project.with_entity("performers", FIRST, performer))
    yield document
    document.close()


@pytest.fixture
def live(document):
    return RowLive(document)


def play(document, *clips):
    document.replace("performers", FIRST, replace(document.project.performers[FIRST], clips=clips), "Clips")
    QApplication.processEvents()


def at(timeline, seconds):
    row = timeline.row_rect("clip", FIRST)
    return QPoint(round(timeline.x_of_frame(0) + pixels(timeline, seconds * RATE)), row.center().y())


def said(timeline, seconds):
    return hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(at(timeline, seconds)))


def marks(timeline, seconds, colour):
    """Pixels of nearly a colour in the row about a time."""
    picture, place = timeline.grab().toImage(), timeline.tracks.mapTo(timeline, at(timeline, seconds))
    wanted = QColor(colour).getRgb()
    near = [picture.pixelColor(place.x() + dx, place.y() + dy).getRgb() for dx in range(-2, 3) for dy in range(-9, 0)]
    return sum(max(abs(a - b) for a, b in zip(each, wanted, strict=True)) < 40 for each in near)


def test_an_overlap_is_marked_in_the_frame_in_which_the_later_clip_takes_over(document, timeline, live):
    assert OVER.start <= live.takes_over <= 1.0
    assert f"Transition at {live.takes_over:.3f} s, at the best matching frame" in said(timeline, 1.3)
    assert marks(timeline, live.takes_over, colours.TEXT) >= 8


def test_a_clip_that_begins_out_of_reach_says_that_the_body_jumps(document, timeline, live):
    play(document, BEFORE, replace(OVER, joined=False, offset=(5.0, 0.0)))
    assert f"Pop at {live.takes_over:.3f} s" in said(timeline, 1.3)
    assert marks(timeline, live.takes_over, colours.PARTLY) >= 8
    document.undo_stack.undo()
    assert "jumps" not in said(timeline, 1.3)


def test_the_first_clip_and_parts_of_a_split_one_take_over_from_nobody(document, timeline):
    assert "\n" not in said(timeline, 0.3)
    play(document, BEFORE, Clip("motion", 60, 100, 1.0, "rest"))
    assert "\n" not in said(timeline, 1.3)


def test_the_name_of_a_clip_stands_where_it_begins_to_play(document, timeline, live):
    """Not where the one before it ends: in a long overlap that is far away, or beyond its own end."""
    play(document, replace(BEFORE, last=100), OVER)
    picture, place = timeline.grab().toImage(), timeline.tracks.mapTo(timeline, at(timeline, live.takes_over))
    rows, columns = range(-4, 6), range(10, 50)
    light = [picture.pixelColor(place.x() + x, place.y() + y).lightness() for x in columns for y in rows]
    assert sum(each > 180 for each in light) > 20
