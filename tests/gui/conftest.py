"""The window, the viewport and the timeline that several files of tests drive; a file may have its own by that name."""

import shutil

import pytest
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication

from studio.app.main_window import MainWindow
from studio.core.captures.contacts import ContactPoint
from studio.document.document import Document
from studio.io.bvh.writer import write_bvh
from studio.library.catalogue import Catalogue
from studio.library.indexing import index_folders
from studio.resources_folder import bundled_strikes_folder
from studio.timeline.timeline import Timeline
from studio.viewport.widget import Viewport
from tests.builders import make_capture, make_constraint, make_contact, make_project
from tests.gui.hand import Hand, curve
from tests.gui.shared_window import SharedWindow
from tests.gui.viewport_use import settle
from tests.patience import PATIENCE
from tests.timeline.fakes import FakeLive
from tests.viewport.standing import StandingLive


@pytest.fixture(autouse=True)
def closed(shared_window):
    """No window but the shared one outlives its test: the theme of the next one would be applied to it as well."""
    yield
    if application := QApplication.instance():
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        windows = [each for each in application.topLevelWidgets() if isinstance(each, MainWindow)]
        left = [each for each in windows if not shared_window.owns(each)]
        for window in left:
            window.deleteLater()
        assert left == []


@pytest.fixture
def project():
    """Project that is open in the window."""
    return make_project(characters=2)


@pytest.fixture(scope="module")
def shared_window():
    """One window for the tests of a file."""
    shared = SharedWindow()
    yield shared
    shared.close()


@pytest.fixture
def window(qtbot, tmp_path, project, shared_window):
    """A small project in the window, nothing playing."""
    yield shared_window.opened(tmp_path / "studio.ini", project)
    shared_window.release()


@pytest.fixture
def studio(qtbot):
    """A viewport with two bodies that stand, its document and its engine's part."""
    document = Document(make_project(characters=2, constraints=1))
    live = StandingLive(document)
    viewport = Viewport(document, live)
    viewport.resize(600, 400)
    with qtbot.waitSignal(viewport.started, timeout=PATIENCE):
        viewport.show()
    document.playhead.set_time(0.2)
    settle(viewport)
    yield viewport, document, live
    viewport.close()
    viewport.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@pytest.fixture(scope="session")
def bundled_library_folder(tmp_path_factory):
    """The library of the bundled strikes, read once."""
    folder = tmp_path_factory.mktemp("bundled") / "library"
    with Catalogue(folder) as catalogue:
        index_folders(catalogue, [bundled_strikes_folder()])
    return folder


@pytest.fixture
def library_folder(bundled_library_folder, tmp_path):
    """A library of the bundled strikes of the test's own."""
    return shutil.copytree(bundled_library_folder, tmp_path / "library")


@pytest.fixture
def walk(tmp_path):
    """A BVH file that the studio's own writer made."""
    capture = make_capture(frames=40)
    path = tmp_path / "walk.bvh"
    write_bvh(path, capture.skeleton, capture.poses, capture.frame_rate)
    return path


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0, contacts=0, frames=101)
    project = project.with_entity(
        "constraints", "kick", make_constraint(name="Kick target", activation=curve(20, 30, 50, 60))
    )
    for key, first, last in (("early", 5, 15), ("late", 70, 90)):
        contact = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        project = project.with_entity("contacts", key, contact)
    document = Document(project)
    yield document
    document.close()


@pytest.fixture
def live(document):
    return FakeLive(document)


@pytest.fixture
def timeline(qtbot, document, live):
    timeline = Timeline(document, live)
    qtbot.addWidget(timeline)
    timeline.resize(1296, 350)
    timeline.show()
    QApplication.processEvents()
    return timeline


@pytest.fixture
def hand(timeline):
    return Hand(timeline)
