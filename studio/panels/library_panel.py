"""Library panel: the entities of the project, the visibility of characters, and scenes that can be opened.

The panel's selection and the document's selection are kept equal.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import (
    QAbstractListModel,
    QEvent,
    QItemSelection,
    QItemSelectionModel,
    QMimeData,
    QModelIndex,
    QPersistentModelIndex,
    QRect,
    QSignalBlocker,
    Qt,
    Signal,
)
from PySide6.QtGui import QCursor, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QLineEdit, QListView, QVBoxLayout, QWidget

from studio.core.stage.project import Performer
from studio.document.document import Document
from studio.document.dragging import CAPTURE_MIME, LIBRARY_ITEM_MIME, item_drag_data
from studio.panels.library_delegate import EYE_COLUMN_PX, LIBRARY_ROW_ROLE, LibraryDelegate
from studio.panels.library_rows import BUNDLED_SCENE, SAVED_PROJECT, SCENE_COLLECTIONS, LibraryRow, rows_of, scene_rows
from studio.panels.thumbnails import Thumbnails

EYE_HINT = "Click the eye to show/hide the selected items; Alt+click to solo."
Index = QModelIndex | QPersistentModelIndex


class LibraryModel(QAbstractListModel):
    """Qt model of the rows; titles and hints cannot be selected."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: list[LibraryRow] = []

    def show(self, rows: list[LibraryRow]) -> None:
        """Set the rows; if only texts differ, the scroll position is kept."""
        if [row.item for row in rows] == [row.item for row in self.rows]:
            self.rows = rows
            self.dataChanged.emit(self.index(0), self.index(len(rows) - 1))
        else:
            self.beginResetModel()
            self.rows = rows
            self.endResetModel()

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008 - Qt's own default
        return 0 if parent.isValid() else len(self.rows)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        row = self.rows[index.row()]
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return row.text
            case Qt.ItemDataRole.AccessibleTextRole:
                shown = {None: "", True: ", shown", False: ", hidden"}[row.shown]
                return f"{row.text} {row.detail}{shown}".strip()
            case Qt.ItemDataRole.ToolTipRole if row.item is not None:
                eye = "" if row.shown is None else f"\n{EYE_HINT}"
                return "\n".join(filter(None, (f"{row.text}  {row.detail}{eye}", row.description)))
        return row if role == LIBRARY_ROW_ROLE else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        row = self.rows[index.row()] if index.isValid() else None
        if row is None or row.item is None:
            return Qt.ItemFlag.NoItemFlags
        can_be_dragged = row.item[0] in ("captures", *SCENE_COLLECTIONS) or row.shown is False
        dragged = Qt.ItemFlag.ItemIsDragEnabled if can_be_dragged else Qt.ItemFlag.NoItemFlags
        return Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | dragged

    def mimeTypes(self) -> list[str]:
        return [LIBRARY_ITEM_MIME, CAPTURE_MIME]

    def mimeData(self, indexes: Sequence[QModelIndex]) -> QMimeData:
        """MIME data of the first dragged row: a capture, a character that is not on the stage, or a scene."""
        items = [row.item for row in (self.rows[each.row()] for each in indexes) if row.item]
        return item_drag_data(items[0])


class LibraryView(QListView):
    """List view with clickable eyes."""

    eye_clicked = Signal(object)
    solo_clicked = Signal(object)
    opened = Signal(object)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        row = self._row_at(event)
        if row is not None and row.shown is not None and self._eye(event).contains(event.position().toPoint()):
            solo = event.modifiers() & Qt.KeyboardModifier.AltModifier
            (self.solo_clicked if solo else self.eye_clicked).emit(row)
            return
        super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        row = self._row_at(event)
        if row is not None and row.item is not None:
            self.opened.emit(row)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        index = self.currentIndex()
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and index.isValid():
            self.opened.emit(index.data(LIBRARY_ROW_ROLE))
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Let the arrow keys move through the list while it has the focus, instead of through time."""
        arrows = (Qt.Key.Key_Up, Qt.Key.Key_Down)
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and event.key() in arrows:
            event.accept()
            return True
        return bool(super().event(event))

    def _row_at(self, event: QMouseEvent) -> LibraryRow | None:
        index = self.indexAt(event.position().toPoint())
        row: LibraryRow | None = index.data(LIBRARY_ROW_ROLE) if index.isValid() else None
        return row

    def _eye(self, event: QMouseEvent) -> QRect:
        rect = self.visualRect(self.indexAt(event.position().toPoint()))
        return rect.adjusted(rect.width() - EYE_COLUMN_PX, 0, 0, 0)


class SearchField(QLineEdit):
    """Search field of the library. Esc clears the text; Esc, Return and Down emit ``left``, on which the list takes the
    focus.
    """

    left = Signal()
    KEYS = (Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Down)

    def __init__(self) -> None:
        super().__init__()
        self.setPlaceholderText("Search names and tags")
        self.setAccessibleName("Search outliner")
        self.setClearButtonEnabled(True)

    def event(self, event: QEvent) -> bool:
        """Reserve the field's keys from shortcuts while it has the focus."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and event.key() in self.KEYS:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self.clear()
        if event.key() in self.KEYS:
            self.left.emit()
        else:
            super().keyPressEvent(event)


class LibraryPanel(QWidget):
    """Content of the library panel.

    ``performance_requested`` carries the id of a capture to be played by the visible characters, ``scene_requested``
    the key of a bundled scene, ``project_requested`` the path of a project file to be opened.
    """

    performance_requested = Signal(str)
    scene_requested = Signal(str)
    project_requested = Signal(Path)

    def __init__(self, document: Document, recent: Iterable[Path] = ()) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.document = document
        self.model = LibraryModel()
        self._scenes = scene_rows(recent)
        self.search_field = SearchField()
        self.view = LibraryView()
        self.view.setAccessibleName("Outliner")
        self.view.setModel(self.model)
        self.thumbnails = Thumbnails(document)
        self.view.setItemDelegate(LibraryDelegate(self.view, self.thumbnails))
        self.view.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.view.setUniformItemSizes(False)
        self.view.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.view.setDragEnabled(True)
        self.view.setResizeMode(QListView.ResizeMode.Adjust)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 8, 0, 0)
        field = QVBoxLayout()
        field.setContentsMargins(8, 0, 8, 0)
        field.addWidget(self.search_field)
        column.addLayout(field)
        column.addWidget(self.view)
        self.search_field.textChanged.connect(self.refresh)
        self.search_field.left.connect(self.view.setFocus)
        self.view.selectionModel().selectionChanged.connect(self._select)
        self.view.clicked.connect(self._select)  # a row that is lit already may stand beside what is current
        self.view.eye_clicked.connect(self._toggle)
        self.view.solo_clicked.connect(self._solo)
        self.view.opened.connect(self._open)
        document.entity_changed.connect(self._entity_changed)
        document.project_opened.connect(self._project_opened)
        document.selection.changed.connect(self._selection_changed)
        self.refresh()

    def refresh(self) -> None:
        """Update all rows; the row under the mouse does not move."""
        anchor, bar = self._anchor(), self.view.verticalScrollBar()
        scrolled = bar.value()
        with QSignalBlocker(self.view.selectionModel()):
            self.model.show(self._rows())
        if anchor is not None:
            item, top = anchor
            scrolled = bar.value() + self.row_rect(item).top() - top
        bar.setValue(scrolled)
        self._show_selection()

    def show_recent(self, recent: Iterable[Path]) -> None:
        """List project files, newest first, with their thumbnails."""
        self._scenes = scene_rows(recent)
        self.thumbnails.forget_saved()
        self.refresh()

    def _anchor(self) -> tuple[tuple[str, str], int] | None:
        """Item whose row must not move, with its top in pixels: the one under the mouse, else the current one if it is
        in view. None without one.
        """
        remaining = {row.item for row in self._rows()}
        mouse, area = self.view.viewport().mapFromGlobal(QCursor.pos()), self.view.viewport().rect()
        rects = {row.item: self.row_rect(row.item) for row in self.model.rows if row.item and row.item in remaining}
        under = [item for item, rect in rects.items() if rect.contains(mouse)]
        current = self.document.selection.current
        seen = [current] if current in rects and rects[current].intersects(area) else []
        return next(((item, rects[item].top()) for item in (*under, *seen) if item), None)

    def _rows(self) -> list[LibraryRow]:
        document = self.document
        return rows_of(document.shown_project, document.active_motion_id, self.search_field.text(), self._scenes)

    def _project_opened(self) -> None:
        self.search_field.clear()
        self.refresh()

    def _show_change(self) -> None:
        """Update the rows if they have changed, which most drags do not."""
        if self._rows() != self.model.rows:
            self.refresh()

    def row_rect(self, item: tuple[str, str]) -> QRect:
        """Rectangle of an item's row in the viewport of the list."""
        return self.view.visualRect(self._index(item))

    def _index(self, item: tuple[str, str]) -> QModelIndex:
        places = [index for index, row in enumerate(self.model.rows) if row.item == item]
        return self.model.index(places[0]) if places else QModelIndex()

    def _entity_changed(self, collection: str, _: str) -> None:
        if collection not in ("contacts", "labels"):
            self._show_change()

    def _selection_changed(self) -> None:
        # Another performer may play another motion, which has other constraints.
        self.refresh()

    def _show_selection(self) -> None:
        model = self.view.selectionModel()
        chosen = QItemSelection()
        for item in self.document.selection.items:
            index = self._index(item)
            if index.isValid():
                chosen.select(index, index)
        with QSignalBlocker(model):
            model.select(chosen, QItemSelectionModel.SelectionFlag.ClearAndSelect)
            current = self.document.selection.current
            if current is not None:
                model.setCurrentIndex(self._index(current), QItemSelectionModel.SelectionFlag.NoUpdate)
                self.view.scrollTo(self._index(current))
        self.view.viewport().update()

    def _select(self) -> None:
        rows = [index.data(LIBRARY_ROW_ROLE) for index in self.view.selectionModel().selectedIndexes()]
        entities = [row.item for row in rows if row.item is not None and row.item[0] not in SCENE_COLLECTIONS]
        if entities or not rows:  # a scene is no part of the project
            self.document.selection.set(*entities)

    def _toggle(self, row: LibraryRow) -> None:
        collection, entity_id = row.item or ("", "")
        if collection == "performers":
            chosen = self.document.selection.of("performers")
            visible = not self.document.project.performers[entity_id].visible
            keys = chosen if entity_id in chosen else (entity_id,)
            self._show_performers(dict.fromkeys(keys, visible), "Show" if visible else "Hide")
        else:
            self._put_on_stage(entity_id)

    def _solo(self, row: LibraryRow) -> None:
        """Show only one performer, or those selected with it; show all if only they are visible already."""
        collection, entity_id = row.item or ("", "")
        if collection != "performers":
            return
        performers, chosen = self.document.project.performers, self.document.selection.of("performers")
        kept = chosen if entity_id in chosen else (entity_id,)
        alone = all(each.visible == (key in kept) for key, each in performers.items())
        self._show_performers({key: alone or key in kept for key in performers}, "Show all" if alone else "Solo")

    def _show_performers(self, visible: dict[str, bool], verb: str) -> None:
        """Set the visibility of performers by id, in one undo step."""
        performers = self.document.project.performers
        names = [performers[key].name for key in visible]
        what = names[0] if len(names) == 1 else f"{len(names)} characters"
        with self.document.group(f"{verb} {what}"):
            for key, shown in visible.items():
                self.document.replace("performers", key, replace(performers[key], visible=shown), verb)

    def _put_on_stage(self, character_id: str) -> None:
        project = self.document.project
        active = project.performers.get(self.document.active_performer_id or "")
        side = max((other.position[1] for other in project.performers.values()), default=-1.2)
        character = project.characters[character_id]
        performer = Performer(character.name, character_id, active.clips if active else (), (0.0, side + 1.2))
        self.document.add("performers", performer, f"Show {character.name}")

    def open_item(self, item: tuple[str, str]) -> None:
        """Play the capture, open the scene or project, or show or hide the body of that row, as a double click does."""
        index = self._index(item)
        if index.isValid():
            self._open(index.data(LIBRARY_ROW_ROLE))

    def _open(self, row: LibraryRow) -> None:
        match row.item:
            case ("captures", capture_id):
                self.performance_requested.emit(capture_id)
            case (collection, key) if collection == BUNDLED_SCENE:
                self.scene_requested.emit(key)
            case (collection, path) if collection == SAVED_PROJECT:
                self.project_requested.emit(Path(path))
            case _ if row.shown is not None:
                self._toggle(row)
