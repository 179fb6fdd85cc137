"""Preferences dialog: every change is applied at once."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QDialog, QHeaderView, QTableWidget, QTableWidgetItem, QVBoxLayout

from studio.app.actions import ACTIONS
from studio.app.preferences import (
    FITTED,
    INTEGER_RANGES,
    PREFERENCE_CHOICES,
    WHOLE_CLIP_ACTIVATION,
    conflicts_in,
    key_map_of,
    key_maps,
    keys_in,
)
from studio.app.workbench import Workbench
from studio.core.changed_records import with_fields
from studio.document import colours
from studio.panels.fields import Choice, NumberField, Section, room_on_screen, styled_label
from studio.viewport.navigation import CAMERA_DRAGS, Navigation

SNAP_FIELDS = (
    ("move_step", "Move step", "cm", 0.1, 100.0),
    ("rotate_step", "Rotate step", "°", 0.1, 180.0),
    ("scale_step", "Scale step", "%", 1.0, 100.0),
)
ONION_FIELDS = (
    ("onion_before", "Before", ""),
    ("onion_after", "After", ""),
    ("onion_step", "Step", "frames"),
)
ACTIVATION_CHOICES = ((FITTED, "While the point stays still"), (WHOLE_CLIP_ACTIVATION, "For the whole clip"))
LENGTH_UNIT_CHOICES = (("usual", "m, cm and mm"), ("m", "Metres"), ("cm", "Centimetres"), ("in", "Inches"))
ACTION_ID_ROLE = Qt.ItemDataRole.UserRole


class PreferencesDialog(QDialog):
    """Dialog with snapping steps, onion skins, activation, autosave, theme, units, and a table of editable
    shortcuts.
    """

    def __init__(self, bench: Workbench) -> None:
        super().__init__(bench.window)
        self._bench = bench
        self.setObjectName("preferences_dialog")
        self.setWindowTitle("Preferences")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(QSize(520, 860).boundedTo(room_on_screen(bench.window)))
        section = Section("Gizmo snapping")
        for name, words, unit, low, high in SNAP_FIELDS:
            field = NumberField(words, unit, low, high, low, 2)
            field.show_value(getattr(bench.preferences, name))
            field.edited.connect(lambda value, name=name: self._change(**{name: value}))
            section.add_row(words, field)
        onion = Section("Onion skins")
        for name, words, unit in ONION_FIELDS:
            self._add_whole(onion, name, words, unit)
        work = Section("General")
        self._add_choice(work, "activation", "New constraints active", ACTIVATION_CHOICES)
        self._add_whole(work, "autosave_minutes", "Autosave", "min")
        look = Section("Appearance (after restart)")
        self._add_choice(look, "theme", "Theme", [(name, name.capitalize()) for name in PREFERENCE_CHOICES["theme"]])
        self._add_whole(look, "interface_scale", "Interface scale", "%")
        self._add_choice(look, "lengths", "Linear units", LENGTH_UNIT_CHOICES)
        keys = Section("Shortcuts")
        self.map = Choice("Keymap", [(key, each.name) for key, each in key_maps().items()])
        self.map.show_value(bench.preferences.key_map)
        self.map.value_chosen.connect(lambda key: self._change(key_map=key))
        keys.add_row("Keymap", self.map)
        self.navigation = styled_label("", "hint")
        keys.add_row("Camera", self.navigation)
        self.table = QTableWidget(len(ACTIONS), 2)
        self.table.setAccessibleName("Keyboard shortcuts")
        self.table.setHorizontalHeaderLabels(("Action", "Shortcuts"))
        self.table.verticalHeader().hide()
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.words = styled_label("", "hint")
        column = QVBoxLayout(self)
        for widget in (section, onion, work, look, keys, self.table, self.words):
            column.addWidget(widget)
        self._fill()
        self.table.itemChanged.connect(self._typed)

    def _add_whole(self, section: Section, name: str, words: str, unit: str) -> None:
        [(_, low, high)] = [each for each in INTEGER_RANGES if each[0] == name]
        field = NumberField(words, unit, low, high, 1, 0)
        field.show_value(getattr(self._bench.preferences, name))
        field.edited.connect(lambda value: self._change(**{name: round(value)}))
        section.add_row(words, field)

    def _add_choice(self, section: Section, name: str, words: str, choices: Sequence[tuple[str, str]]) -> None:
        choice = Choice(words, choices)
        choice.show_value(getattr(self._bench.preferences, name))
        choice.value_chosen.connect(lambda value: self._change(**{name: value}))
        section.add_row(words, choice)

    def _change(self, **values: object) -> None:
        self._bench.window.set_preferences(with_fields(self._bench.preferences, **values))
        self._fill()

    def _fill(self) -> None:
        self.navigation.setText(navigation_words(key_map_of(self._bench.preferences).navigation))
        keys = self._bench.window.actions_by_id.keys_now()
        conflicts = conflicts_in(keys)
        self.table.blockSignals(True)
        for line, row in enumerate(ACTIONS):
            name, typed = QTableWidgetItem(f"{row.menu} > {row.text}"), QTableWidgetItem("  ".join(keys[row.id]))
            name.setFlags(Qt.ItemFlag.ItemIsEnabled)
            typed.setData(ACTION_ID_ROLE, row.id)
            if any(key in conflicts for key in keys[row.id]):
                typed.setForeground(QColor(colours.NOT_REACHED))
            self.table.setItem(line, 0, name)
            self.table.setItem(line, 1, typed)
        self.table.blockSignals(False)
        texts = {row.id: row.text for row in ACTIONS}
        told = [f"{key}: {' and '.join(texts[each] for each in actions)}" for key, actions in conflicts.items()]
        self.words.setText(
            f"A shortcut is used twice. {'; '.join(told)}." if told else "Separate several shortcuts with spaces."
        )

    def _typed(self, item: QTableWidgetItem) -> None:
        """Assign the typed shortcuts to the action in the row of ``item``, or report why they are invalid."""
        try:
            keys = keys_in(item.text())
        except ValueError as error:
            self._fill()
            self.words.setText(str(error))
            return
        self._change(own_keys={**self._bench.preferences.own_keys, item.data(ACTION_ID_ROLE): keys})


def navigation_words(navigation: Navigation) -> str:
    """Mouse buttons of the camera as text, for example ``Orbit: Alt+Left  ·  Pan: Middle  ·  Zoom: Alt+Right``."""
    strokes = {drag: [stroke for stroke, kind in navigation.items() if kind == drag] for drag in CAMERA_DRAGS}
    return "  ·  ".join(f"{drag.capitalize()}: {' or '.join(each)}" for drag, each in strokes.items())
