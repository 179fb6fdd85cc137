"""The window's actions as QActions, made from the table of actions, kept up to date, and added to menus and toolbar."""

from collections.abc import Callable, Iterable, Sequence

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu, QMenuBar

from studio.app.actions import ACTIONS, MENUS, Action
from studio.app.preferences import key_map_of, keys_with
from studio.app.verbs import files
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.core.stage.saved_camera import CAMERA_SLOTS
from studio.document.mnemonics import escaped_mnemonics
from studio.document.stored_cameras import camera_in_slot
from studio.panels.message_strip import Lifetime


def with_mnemonics(names: Sequence[str], shortcuts: Iterable[str] = ()) -> list[str]:
    """``names`` with one mnemonic letter marked in each: an early letter that no other name and no shortcut uses.

    ``shortcuts`` are the keys of all actions. Qt ignores a key that two widgets use, so a name without a free letter
    stays unmarked. The letters are assigned by augmenting paths (Kuhn's matching).
    """
    taken = {keys.removeprefix("Alt+").lower() for keys in shortcuts if keys.startswith("Alt+")} | {" "}
    index_of: dict[str, int] = {}  # of the name that is opened by a letter

    def give(index: int, tried: set[str]) -> bool:
        for letter in names[index].lower():
            if letter not in taken | tried:
                tried.add(letter)
                if letter not in index_of or give(index_of[letter], tried):
                    index_of[letter] = index
                    return True
        return False

    for index in range(len(names)):
        give(index, set())
    marked = list(names)
    for letter, index in index_of.items():
        place = marked[index].lower().index(letter)
        marked[index] = f"{marked[index][:place]}&{marked[index][place:]}"
    return marked


class ActionSet(QObject):
    """QActions of the window by id, enabled, checked and named by the state of the document."""

    keys_changed = Signal()
    """The actions have the keys of another key map, or others of the user's own."""

    def __init__(self, bench: Workbench, parent: QObject) -> None:
        super().__init__(parent)
        self._bench = bench
        self.menus: dict[str, QMenu] = {}
        self.by_id: dict[str, QAction] = {row.id: self._make(row) for row in ACTIONS}
        document = bench.document
        for signal in (
            document.undo_stack.indexChanged,
            document.selection.changed,
            document.keys.changed,
            document.project_opened,
            bench.views_changed,
        ):
            signal.connect(self.refresh)
        # One step may change thousands of entities; what can be done is asked once after them.
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self.refresh)
        document.entity_changed.connect(lambda *_: self._soon.start())
        bench.live.interactive_changed.connect(self.refresh)
        bench.live.play.running_changed.connect(self.refresh)
        bench.live.play.recording_changed.connect(self.refresh)

    def refresh(self, *_: object) -> None:
        """Update which actions are enabled and checked, and the texts of undo and redo. During a drag only undo is
        updated.
        """
        if self._bench.live.interactive:
            self.by_id["undo"].setEnabled(True)
            return
        for row in ACTIONS:
            action = self.by_id[row.id]
            action.setEnabled(row.enabled(self._bench))
            if row.checked is not None:
                action.setChecked(row.checked(self._bench))
        cameras = self._bench.document.project.cameras
        for slot in CAMERA_SLOTS:
            camera_id = camera_in_slot(self._bench.document.project, slot)
            name = cameras[camera_id].name if camera_id else f"camera {slot}"
            self.by_id[f"camera_{slot}"].setText(escaped_mnemonics(f"Look through {name}"))
        stack = self._bench.document.undo_stack
        self.by_id["undo"].setText(escaped_mnemonics(f"Undo {_uncapitalised(stack.undoText())}".strip()))
        self.by_id["redo"].setText(escaped_mnemonics(f"Redo {_uncapitalised(stack.redoText())}".strip()))

    def apply_keys(self) -> None:
        """Set the shortcuts of all actions from the key map and the user's own shortcuts."""
        preferences = self._bench.preferences
        changed = key_map_of(preferences).keys
        keys = keys_with({row.id: row.shortcuts for row in ACTIONS}, changed, preferences.own_keys)
        for row in ACTIONS:
            action = self.by_id[row.id]
            action.setShortcuts([QKeySequence(key) for key in keys[row.id]])
            action.setToolTip(_tooltip(row, keys[row.id]))
        self._mark_menus()
        self.keys_changed.emit()

    def keys_now(self) -> dict[str, tuple[str, ...]]:
        """Shortcuts of each action by its id."""
        return {key: tuple(each.toString() for each in action.shortcuts()) for key, action in self.by_id.items()}

    def fill(self, bar: QMenuBar) -> None:
        """Add all actions to their menus."""
        self.menus = {name: bar.addMenu(name) for name in MENUS}
        self._mark_menus()
        for row in ACTIONS:
            self.menus[row.menu].addAction(self.by_id[row.id])
            if row.id == "open":
                self.recent = self.menus[row.menu].addMenu("Open recent")
                self.recent.aboutToShow.connect(self._fill_recent)
            if row.ends_group:
                self.menus[row.menu].addSeparator()

    def by_menu(self) -> dict[str, list[QAction]]:
        """Actions by the name of their menu, for the list of shortcuts."""
        return {name: [self.by_id[row.id] for row in ACTIONS if row.menu == name] for name in MENUS}

    def in_menus(self) -> list[QAction]:
        """All actions in the menus, including those that show panels, for the command palette."""
        found = [action for menu in self.menus.values() for action in menu.actions()]
        return [action for action in found if not action.isSeparator() and action.menu() is None]

    def tools(self) -> list[QAction]:
        """Actions of the tools in the top bar."""
        return [self.by_id[row.id] for row in ACTIONS if row.tool]

    def _mark_menus(self) -> None:
        shortcuts = [keys for of_action in self.keys_now().values() for keys in of_action]
        for menu, text in zip(self.menus.values(), with_mnemonics(list(self.menus), shortcuts), strict=True):
            menu.setTitle(text)

    def _fill_recent(self) -> None:
        self.recent.clear()
        for path in self._bench.settings.recent:
            action = self.recent.addAction(escaped_mnemonics(path.name))
            action.setToolTip(str(path))
            action.triggered.connect(lambda _=False, path=path: files.open_path(self._bench, path))
        if self.recent.isEmpty():
            self.recent.addAction("No recent projects").setEnabled(False)

    def _make(self, row: Action) -> QAction:
        action = QAction(row.text, self)
        action.setProperty("name", row.text)  # what it is called whatever it would undo now
        action.setShortcuts([QKeySequence(keys) for keys in row.shortcuts])
        action.setAutoRepeat(row.repeats)
        action.setIconText(row.tool or row.text)
        action.setCheckable(row.checked is not None)
        action.setToolTip(_tooltip(row, row.shortcuts))
        action.triggered.connect(self._runner(row))
        return action

    def _runner(self, row: Action) -> Callable[[], None]:
        def run() -> None:
            if row.id != "escape":  # it cancels the drag
                self._bench.finish_drag()
            try:
                row.run(self._bench)
            except StudioError as error:
                self._bench.post_message(str(error), until=Lifetime.SELECTED)
            self.refresh()

        return run


def _tooltip(row: Action, keys: tuple[str, ...]) -> str:
    return (row.tooltip or row.text) + (f"  {keys[0]}" if keys else "")


def _uncapitalised(text: str) -> str:
    return text[:1].lower() + text[1:]
