"""One window for the tests of a file: a project that is opened anew makes it a new window, or another one is made."""

from pathlib import Path

from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QLineEdit, QWidget

from studio.app.application import make_application, make_window
from studio.app.main_window import MainWindow
from studio.app.preferences import Preferences
from studio.app.settings import Settings
from studio.core.stage.project import Project
from studio.document.document import Document

SIZE = (1400, 900)


class SharedWindow:
    """Window that tests use one after another, each as a new one."""

    def __init__(self) -> None:
        self._window: MainWindow | None = None
        self._first_state: object = None

    def opened(self, settings: Path, project: Project) -> MainWindow:
        """The window with a project and these settings, as if it were new."""
        self.release()
        if self._window is not None and not self._brought_back(Settings(settings), project):
            self.close()
        if self._window is None:
            self._window = new_window(Settings(settings), project)
            self._first_state = state_of(self._window)
        return self._window

    def release(self) -> None:
        """Close a window that has views of the motion, with all that works for them, as soon as its test has ended."""
        if self._window is not None and (self._window.bench.has_viewport or self._window.bench.has_timeline):
            self.close()

    def owns(self, window: MainWindow) -> bool:
        """True for the window itself."""
        return window is self._window

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            close_window(self._window)
            self._window = None

    def _brought_back(self, settings: Settings, project: Project) -> bool:
        """Show a project in the used window; True if all is as in a new one."""
        assert self._window is not None
        show_anew(self._window, settings, project)
        if state_of(self._window) == self._first_state:
            return True
        self._window.resize(*SIZE)
        self._window.reset_layout()
        QTest.qWait(0)
        return state_of(self._window) == self._first_state


def new_window(settings: Settings, project: Project) -> MainWindow:
    """Visible window with a project, without views of the motion."""
    make_application()
    window = make_window(settings, Document(project))
    window.resize(*SIZE)  # before it is shown, or all is laid out twice
    window.show()
    QTest.qWaitForWindowExposed(window)
    QTest.qWait(0)
    return window


def close_window(window: MainWindow) -> None:
    """Close a window and delete it."""
    window.close_without_saving()
    window.deleteLater()
    QTest.qWait(0)


def show_anew(window: MainWindow, settings: Settings, project: Project) -> None:
    """Show a project in a used window, with other settings and without messages."""
    bench = window.bench
    bench.settings, bench.journals = settings, None
    bench.sources.clear()
    bench.read_as.clear()
    if bench.preferences != Preferences():
        window.set_preferences(Preferences())
    for strip in (window.strip, window.question, window.recovery, window.tour_strip):
        strip.clear()
    window.library.search_field.clear()
    bench.document.new(project)
    window.activateWindow()
    window.setFocus()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QTest.qWait(0)


def state_of(window: MainWindow) -> list[object]:
    """All that is seen of a window, what its actions are, the objects that it is made of, and the panels ever shown.

    A panel that was hidden at first may keep what nobody sees, such as packets that it has received.
    """
    widgets = [each for each in window.findChildren(QWidget) if each.isVisible() or each.isWindow()]
    bench = window.bench
    return [
        sorted(str(_seen(each)) for each in widgets if not isinstance(each.parent(), QLineEdit)),  # its button fades
        [
            (each.text(), each.isEnabled(), each.isChecked(), each.shortcut().toString())
            for each in window.actions_by_id.by_id.values()
        ],
        [each.widget().testAttribute(Qt.WidgetAttribute.WA_WState_Created) for each in window.docks.values()],
        (window.windowTitle(), window.isVisible(), bench.runner.running),
        {
            name: id(each)
            for owner in (window, bench)
            for name, each in vars(owner).items()
            if isinstance(each, QWidget)
        },
    ]


def _seen(widget: QWidget) -> tuple[object, ...]:
    value = widget.metaObject().userProperty()
    return (
        type(widget).__name__,
        widget.isVisible(),
        widget.isEnabled(),
        widget.geometry().getRect(),
        widget.property("text"),
        widget.property("checked"),
        str(value.read(widget)) if value.isValid() else "",
        widget.count() if isinstance(widget, QComboBox) else 0,
    )
