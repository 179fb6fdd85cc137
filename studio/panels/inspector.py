"""Inspector: the form of the selected entity, chosen by its collection and kind."""

from collections.abc import Callable

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.behaviour.behaviour_editor import BehaviourEditor
from studio.panels.behaviour.state_editor import StateEditor
from studio.panels.behaviour.transition_editor import TransitionEditor
from studio.panels.camera_editor import CameraEditor
from studio.panels.capture_editor import CaptureEditor
from studio.panels.character_editor import CharacterEditor
from studio.panels.clip_editor import ClipEditor
from studio.panels.constraint_editors import editor_of_kind
from studio.panels.contact_editor import ContactEditor
from studio.panels.correction_editor import CorrectionEditor
from studio.panels.editor import Editor, PlainEditor
from studio.panels.fields import return_keys
from studio.panels.footage_editor import FootageEditor
from studio.panels.ground_editor import GroundEditor
from studio.panels.label_editor import LabelEditor
from studio.panels.performer_editor import PerformerEditor
from studio.panels.prop_editor import PropEditor
from studio.panels.sound_editor import SoundEditor
from studio.panels.stage_editor import StageEditor

ENTITY_EDITORS: dict[str, Callable[[Document, Live, str, str], Editor[object]]] = {
    "captures": CaptureEditor,
    "characters": CharacterEditor,
    "clips": ClipEditor,
    "performers": PerformerEditor,
    "contacts": ContactEditor,
    "labels": LabelEditor,
    "corrections": CorrectionEditor,
    "grounds": GroundEditor,
    "props": PropEditor,
    "behaviours": BehaviourEditor,
    "cameras": CameraEditor,
    "sounds": SoundEditor,
    "footage": FootageEditor,
    "states": StateEditor,
    "transitions": TransitionEditor,
}
DRAG_REFRESH_MILLISECONDS = 100
"""Milliseconds between two updates of the form during a drag, so that characters are updated first."""


def _silence(editor: Editor[object]) -> None:
    """Disconnect a form whose entity was deleted, so that its fields no longer change anything."""
    if editor.gesture is not None:
        editor.end()
    for child in editor.findChildren(QWidget):
        child.blockSignals(True)


class Inspector(QScrollArea):
    """Inspector, which shows the form of the selection and keeps it up to date."""

    reimport_requested = Signal(str, object)
    steps_requested = Signal(str)
    """Emitted with the capture's id to make the steps that were detected the ground."""
    markers_requested = Signal(str)
    """Emitted with the capture's id to open its markers."""
    character_requested = Signal(str)
    """Emitted with the capture's id to create a character from its actor."""
    remap_requested = Signal(str, object, str)
    """Emitted with the character's id, {part: joint} and the text of the undo step, to bind the character with another
    body map.
    """

    def __init__(self, document: Document, live: Live) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setAccessibleName("Inspector")
        self.document, self.live = document, live
        self.editor: Editor[object] | None = None
        document.selection.changed.connect(self._show_current)
        document.entity_changed.connect(self._entity_changed)
        document.project_opened.connect(self._show_current)
        self._dragged = QTimer(self, singleShot=True, interval=DRAG_REFRESH_MILLISECONDS)
        self._dragged.timeout.connect(self._refresh)
        self._show_current()

    def _show_current(self) -> None:
        item = self.document.selection.current
        if item is not None and self.document.project.get(*item) is None:
            item = None
        collection, entity_id = item or ("", "")
        editor = self.editor
        if editor is not None and (editor.collection, editor.entity_id) == (collection, entity_id) and item:
            editor.refresh()
            editor.update_title()
            return
        self.editor = self._make(collection, entity_id)
        if isinstance(self.editor, CaptureEditor):
            self.editor.reimport_requested.connect(self.reimport_requested)
            self.editor.steps_requested.connect(self.steps_requested)
            self.editor.markers_requested.connect(self.markers_requested)
            self.editor.character_requested.connect(self.character_requested)
        if isinstance(self.editor, CharacterEditor | PerformerEditor):
            self.editor.remap_requested.connect(self.remap_requested)
        if editor is not None:
            # It may be in the middle of an event of its own: it stays a child until the event loop lets it go.
            return_keys(editor)
            self.takeWidget()
            if editor.collection and editor.entity is None:
                _silence(editor)
            editor.hide()
            editor.setParent(self)
            editor.deleteLater()
        self.setWidget(self.editor)

    def _make(self, collection: str, entity_id: str) -> Editor[object]:
        if not collection:
            return StageEditor(self.document, self.live)
        if collection == "constraints":
            kind = self.document.project.constraints[entity_id].kind
            return editor_of_kind(kind)(self.document, self.live, collection, entity_id)
        return ENTITY_EDITORS.get(collection, PlainEditor)(self.document, self.live, collection, entity_id)

    def _entity_changed(self, collection: str, entity_id: str) -> None:
        editor = self.editor
        if editor is None:
            return
        if editor.collection and editor.entity is None:
            self._show_current()
        elif editor.depends_on(collection, entity_id) or (collection == editor.collection and not entity_id):
            if not self.live.interactive:
                editor.refresh()
                editor.update_title()
            elif not self._dragged.isActive():
                self._dragged.start()

    def _refresh(self) -> None:
        if self.editor is not None and (not self.editor.collection or self.editor.entity is not None):
            self.editor.refresh()
            self.editor.update_title()

    def current_form(self) -> QWidget | None:
        """Form that is shown; None if there is none."""
        return self.editor
