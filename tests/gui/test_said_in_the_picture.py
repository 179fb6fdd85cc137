"""Words and lines in the picture itself: names of twins, and lines to whom somebody looks at."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtTest import QTest

from studio.app.application import import_views, show_views
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.document.document import Document
from studio.viewport.opening import CHIPS_HEIGHT_PX
from studio.viewport.overlay import Overlay
from studio.viewport.widget import Viewport
from tests.builders import make_project
from tests.gui.viewport_use import settle
from tests.patience import PATIENCE, SECONDS
from tests.viewport.standing import StandingLive

NAME_HEIGHT = 17
"""Pixels from the place of a name up to its upper edge."""


@pytest.fixture
def twins(qtbot):
    """A viewport with two bodies of one character, of whom the second looks at the first one's head."""
    project = make_project(characters=2, constraints=0)
    twin = replace(project.performers["performer 1"], character_id="character 0")
    gaze = LookAtConstraint(
        "motion", "Look", EYES_POINT, Chain(), 0, ActivationCurve(0.0, 0.0, 1.0, 1.0),
        target=FollowPerformer("performer 0", BodyPoint(BodyPart.HEAD)), scope=Scope(performer_id="performer 1"),
    )  # fmt: skip
    document = Document(project.with_entity("performers", "performer 1", twin).with_entity("constraints", "look", gaze))
    viewport = Viewport(document, StandingLive(document))
    qtbot.addWidget(viewport)
    viewport.resize(900, 600)
    with qtbot.waitSignal(viewport.started, timeout=PATIENCE):
        viewport.show()
    document.playhead.set_time(0.2)
    settle(viewport)
    yield viewport, document
    viewport.close()


def drawn(viewport, monkeypatch, method):
    """The arguments with which a method of the overlay is called in the next picture."""
    calls, real = [], getattr(Overlay, method)

    def noted(self, *arguments):
        calls.append(arguments)
        return real(self, *arguments)

    monkeypatch.setattr(Overlay, method, noted)
    viewport.grab()
    QTest.qWait(5)
    return calls


def test_bodies_of_one_character_have_their_names_over_their_heads(twins, monkeypatch):
    viewport, document = twins
    [names, *_] = drawn(viewport, monkeypatch, "names")
    tops = names[0]
    assert list(tops) == ["Body 0", "Body 1"]
    for key, name in (("performer 0", "Body 0"), ("performer 1", "Body 1")):
        assert tops[name][2] == pytest.approx(viewport.posed[key].points[:, 2].max(), abs=0.1)
    other = replace(document.project.performers["performer 1"], character_id="character 1")
    document.replace("performers", "performer 1", other, "Change character")
    settle(viewport)
    assert drawn(viewport, monkeypatch, "names")[-1][0] == {}


def test_names_of_heads_at_the_upper_edge_stand_below_the_chips(twins, monkeypatch):
    viewport, _ = twins
    places, real = [], Overlay._name

    def noted(self, place, *others):
        places.append(place)
        return real(self, place, *others)

    monkeypatch.setattr(Overlay, "_name", noted)
    head = max(pose.points[:, 2].max() for pose in viewport.posed.values())
    below_heads = np.array([[0.0, 0.0, head - 0.5], [0.3, 0.0, head - 0.1]])
    viewport.set_camera(viewport.camera.framing(below_heads, viewport.view_size, 0.8))
    settle(viewport)
    viewport.grab()
    QTest.qWait(5)
    chips = viewport._chips.view.geometry().bottom()
    assert places
    assert all(place[1] - NAME_HEIGHT > chips for place in places)


def test_a_line_leads_from_the_eyes_to_what_they_look_at_whoever_is_active_and_while_it_plays(twins, monkeypatch):
    viewport, document = twins
    document.selection.set(("performers", "performer 0"))
    settle(viewport)
    [look] = [one for one in viewport.handles() if one.kind == "look_at"]
    seen = viewport.posed["performer 0"]
    head = seen.points[seen.motion.morphology.layout.head_joint]
    assert np.linalg.norm(look.figure.link[1] - head) < 0.1
    document.playhead.play()
    [[handles, _], *_] = drawn(viewport, monkeypatch, "handles")
    assert [one.kind for one in handles] == ["look_at"]
    document.playhead.pause()


def test_feet_stand_above_the_sentence_that_is_said_as_the_stage_opens(window, qtbot):
    window.strip.show_sentence("A scene's sentence of what is to be seen, " * 6)
    import_views()
    show_views(window)
    viewport = window.bench.viewport
    assert window.bench.live.wait_until_solved(SECONDS)
    qtbot.waitUntil(lambda: len(viewport.posed) == 2, timeout=PATIENCE)
    settle(viewport)
    points = np.concatenate([pose.points for pose in viewport.posed.values()])
    pixels, _ = viewport.camera.project(points, viewport.view_size)
    above = viewport.mapFromGlobal(window.strip.mapToGlobal(window.strip.rect().topLeft())).y()
    assert pixels[:, 1].max() <= above
    viewport.frame_all()
    settle(viewport)
    pixels, _ = viewport.camera.project(points, viewport.view_size)
    assert CHIPS_HEIGHT_PX <= pixels[:, 1].min() < pixels[:, 1].max() <= above
