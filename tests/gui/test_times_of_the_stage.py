"""Times are those of the stage's ruler, with the clip's own frame in brackets; contact rows stay within their clip."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPointF

from studio.core.captures.contacts import ContactPoint
from studio.core.stage.clip import Clip
from studio.document.document import Document
from studio.timeline.hover import hover_text
from tests.builders import make_constraint, make_contact, make_project
from tests.gui.hand import RATE, curve, in_lane, pixels

START = 300
"""Frame of the stage at which the second clip begins with frame 20 of the motion."""


@pytest.fixture
def document(qapp):
    project = make_project(characters=1, constraints=0, contacts=0, frames=101)
    clips = (Clip("motion", 0, 90, 0.0, "first"), Clip("motion", 20, 80, START / RATE, "second"))
    performer = replace(project.performers["performer 0"], clips=clips)
    project = project.with_entity("performers", "performer 0", performer)
    constraint = make_constraint(name="kick", activation=curve(30, 40, 50, 60))
    project = project.with_entity("constraints", "kick", constraint)
    for key, first, last in (("before", 2, 12), ("across", 15, 30), ("inside", 40, 60), ("out", 75, 95)):
        contact = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        project = project.with_entity("contacts", key, contact)
    document = Document(project)
    document.selection.set(("performers", "performer 0"), ("clips", "second"))
    yield document
    document.close()


def text_at(timeline, place):
    return hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place))


def test_hover_speaks_in_frames_of_the_stage(timeline):
    row = timeline.row_rect("constraints", "kick")
    text = text_at(timeline, QPointF(timeline.x_of_frame(325), row.top() + 12))
    assert text == "kick: activation 100% at frame 325 (45 of the clip)"
    assert text_at(timeline, in_lane(timeline, 330)).startswith(
        "Left heel contact: frame 320 (40 of the clip) to frame 340 (60 of the clip)"
    )


def test_a_drag_tells_frames_of_the_stage(timeline, hand):
    row = timeline.row_rect("constraints", "kick")
    hand.press(QPointF(timeline.x_of_frame(325), row.top() + 12).toPoint())
    hand.move(pixels(timeline, 5))
    assert timeline.tracks.gesture.mark.text.endswith("5.250 s · frame 315 (35 of the clip)")
    hand.release()


def test_where_clip_and_stage_agree_there_are_no_brackets(document, timeline):
    document.selection.set(("performers", "performer 0"), ("clips", "first"))
    row = timeline.row_rect("constraints", "kick")
    text = text_at(timeline, QPointF(timeline.x_of_frame(45), row.top() + 12))
    assert text == "kick: activation 100% at frame 45"


def kinds(timeline, *frames):
    return [timeline.tracks.sheet.part_under_playhead(QPointF(in_lane(timeline, frame))).id for frame in frames]


def test_contact_rows_do_not_reach_beyond_their_clip(timeline):
    assert kinds(timeline, 305, 330, 358) == ["across", "inside", "out"]
    assert kinds(timeline, 285, 294, 297) == ["left_heel"] * 3


def test_a_contact_that_the_clip_cuts_is_trimmed_at_the_end_that_is_seen(document, timeline, hand):
    hand.drag(in_lane(timeline, 310), pixels(timeline, 4))
    contact = document.project.contacts["across"]
    assert (contact.first, contact.last) == (15, 34)
