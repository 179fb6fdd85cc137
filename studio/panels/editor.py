"""Base class of all forms of the inspector, which show and edit one entity."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Generic, Protocol, TypeVar, cast

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QVBoxLayout, QWidget

from studio.core.changed_records import with_fields
from studio.core.errors import StudioError
from studio.core.stage.project import Entity
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.fields import NumberField, TextField, styled_label
from studio.panels.shared_edits import different_fields, with_edit

EDITED_TOGETHER = {name: name for name in ("constraints", "contacts", "clips", "props")} | {"performers": "characters"}
"""Collections in which an edit in the form applies to all selected entities, with their words for the user."""


EditedT_co = TypeVar("EditedT_co", covariant=True)
"""Type that a form shows: an entity, or a part of one."""


class NamedEntity(Protocol):
    """Entity whose name appears in the texts of undo steps."""

    @property
    def name(self) -> str: ...


class Editor(QWidget, Generic[EditedT_co]):
    """Form of one entity. It keeps no copy of it: ``refresh`` reads it from the document, ``change`` replaces it
    there.
    """

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.document, self.live = document, live
        self.collection, self.entity_id = collection, entity_id
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 12)
        self.column.setSpacing(0)
        self._together = styled_label("", "hint")
        self._together.setContentsMargins(12, 8, 12, 0)
        self._together.hide()
        self.column.addWidget(self._together)
        self._gesture: int | None = None

    @property
    def edited_ids(self) -> tuple[str, ...]:
        """Ids of the selected entities that are edited together, the shown one included."""
        selected = self.document.selection.of(self.collection)
        return selected if self.entity_id in selected else (self.entity_id,)

    def update_title(self) -> None:
        """Show how many entities an edit will change, and the fields in which they differ."""
        ids = self.edited_ids
        self._together.setVisible(len(ids) > 1 and self.collection in EDITED_TOGETHER)
        if len(ids) > 1 and self.collection in EDITED_TOGETHER:
            entities = [self.document.shown_project.get(self.collection, key) for key in ids]
            mixed = ", ".join(different_fields(entities))
            self._together.setText(
                f"{len(ids)} {EDITED_TOGETHER[self.collection]} are edited together."
                + (f" Mixed values: {mixed}." if mixed else "")
            )

    @property
    def gesture(self) -> int | None:
        """Number of the current drag, to whose undo step edits belong; None without a drag."""
        return self._gesture

    @property
    def entity(self) -> EditedT_co:
        """Shown entity, mirrored if the active clip is; None if it was deleted."""
        return cast(EditedT_co, self.document.shown_project.get(self.collection, self.entity_id))

    def refresh(self) -> None:
        """Show the current values of the entity."""

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True if the form must be updated when the given entity changes."""
        return (collection, entity_id) == (self.collection, self.entity_id)

    def change(self, text: str, **values: object) -> None:
        """Replace the entity by a copy with the given ``values``; an invalid edit is reported as a message."""
        entity = cast(Entity, self.entity)  # what is no entity of its own is changed by the form of its owner
        self.replace_entity(lambda: with_fields(entity, **values), text)

    def replace_entity(self, make: Callable[[], Entity], text: str) -> None:
        """Replace the entity by the result of ``make``; an invalid edit is reported as a message."""
        others = [key for key in self.edited_ids if key != self.entity_id] if self.collection in EDITED_TOGETHER else []
        before = self.entity
        if others:
            text += f" and {len(others)} other{'' if len(others) == 1 else 's'}"
        with self._objections_told(), self.document.group(text, self._gesture):
            after = make()
            self.document.replace_shown(self.collection, self.entity_id, after, text)
            for key in others:
                edited = with_edit(self.document.shown_project.get(self.collection, key), before, after)
                self.document.replace_shown(self.collection, key, edited, text)

    def put_other(self, collection: str, entity_id: str, make: Callable[[], Entity], text: str) -> None:
        """Replace another entity, which belongs to the shown one, by the result of ``make``; an invalid edit is
        reported as a message.
        """
        with self._objections_told():
            self.document.replace_shown(collection, entity_id, make(), text, self._gesture)

    @contextmanager
    def _objections_told(self) -> Iterator[None]:
        """Context that reports an invalid edit as a message, and then shows the unchanged entity."""
        try:
            yield
        except (ValueError, StudioError) as error:
            self.document.problem_reported.emit(f"{error}")
            self.refresh()

    def begin(self) -> None:
        """Begin a drag, whose changes are one undo step and are solved first around the playhead."""
        self._gesture = self.document.new_gesture()
        self.live.interactive = True

    def end(self) -> None:
        """End the drag."""
        self._gesture = None
        self.live.interactive = False

    def bind(self, field: NumberField, change: Callable[[float], None]) -> NumberField:
        """Let a number field change the entity, as one undo step per drag; it does nothing after the entity is
        deleted.
        """

        def changed(number: float) -> None:
            if not self.collection or self.entity is not None:  # a field that is left is read once more
                change(number)

        field.begun.connect(self.begin)
        field.edited.connect(changed)
        field.ended.connect(self.end)
        return field

    def finish(self) -> None:
        """Complete the form; the space below the last section stays empty."""
        self.column.addStretch(1)
        self.refresh()
        self.update_title()


class EntityNameField(TextField):
    """Text field for the name of the shown entity."""

    def __init__(self, editor: Editor[NamedEntity], kind: str = "") -> None:
        super().__init__()
        self._editor, self._kind = editor, kind
        self.editingFinished.connect(self._rename)

    def show_name(self) -> None:
        """Show the name of the entity, unless the user is typing."""
        if not self.hasFocus() or not self.isModified():
            self.setText(self._editor.entity.name)

    def _rename(self) -> None:
        entity, name = self._editor.entity, self.text().strip()
        if entity is None:
            return  # a field that is left is read once more when its entity is gone
        if name and name != entity.name:
            self._editor.change(f"Rename {self._kind}{entity.name}", name=name)
        self.show_name()


class PlainEditor(Editor[Entity]):
    """Form for entities without a form of their own: shows the values as text."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        self._words = styled_label("", "hint")
        self._words.setContentsMargins(12, 12, 12, 0)
        self.column.addWidget(self._words)
        self.finish()

    def refresh(self) -> None:
        """Show name and values of the entity."""
        values = vars(self.entity)
        plain = {key: value for key, value in values.items() if isinstance(value, (str, int, float, tuple))}
        self._words.setText("\n".join(f"{key.replace('_', ' ')}: {value}" for key, value in plain.items()))
