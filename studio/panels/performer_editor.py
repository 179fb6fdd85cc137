"""Form of a performer: visibility, placement, clips, and the proportions of its character."""

import math
from collections.abc import Callable

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QLabel

from studio.core.stage.project import Performer
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.body_map_section import character_section
from studio.panels.character_editor import BodySection
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import Choice, NumberField, Section, check_box, styled_label, with_unit

PLACEMENT_LIMIT = 1000.0


class PerformerEditor(Editor[Performer]):
    """Form of a performer and its character, which to the animator are one character on the stage."""

    remap_requested = Signal(str, object, str)
    """Emitted with the character's id, {part: joint} and the text of the undo step, to bind the character with another
    body map.
    """

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Character")
        self._visible = check_box("shown")
        self._visible.toggled.connect(self._show_or_hide)
        section.head.addWidget(self._visible)
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._cast = Choice("Character", [])
        self._cast.value_chosen.connect(self._recast)
        section.add_row("Character", self._cast)
        self._plays: QLabel = styled_label("", "value")
        section.add_row("Plays", self._plays)
        self._x, self._y = (
            self.bind(
                NumberField(f"Position {axis}", "m", -PLACEMENT_LIMIT, PLACEMENT_LIMIT, 0.01, suffix=False),
                self._mover(k),
            )
            for k, axis in enumerate("XY")
        )
        section.add_row(with_unit("Position", "m"), self._x, self._y)
        self._heading = self.bind(NumberField("Heading", "°", -360.0, 360.0, 1.0, 1), self._turn)
        section.add_row("Heading", self._heading)
        self._limited = check_box("Limit to human range")
        self._limited.setToolTip(
            "Joint limits for constraints: shoulders, elbows, wrists, hips, knees and ankles stay in human"
            " range (or in that of the source capture)."
        )
        self._limited.toggled.connect(self._limit_or_free)
        section.add_row("Joints", self._limited)
        self._eased = check_box("Smooth pops")
        self._eased.setToolTip(
            "Frames around a pop are smoothed; constraints may be missed briefly there, lowest priority first."
            " Off: every frame is solved exactly, even if joints pop."
        )
        self._eased.toggled.connect(self._ease_or_not)
        section.add_row("Smoothing", self._eased)
        self._clears = check_box("Arm self-collision")
        self._clears.setToolTip(
            "Keeps hands, forearms and elbows out of torso, head and thighs; source self-contacts are kept."
            " Hand constraints have priority; the elbow moves."
        )
        self._clears.toggled.connect(self._clear_or_not)
        section.add_row("Arms", self._clears)
        self._body = BodySection(self, lambda: self.entity.character_id)
        self.column.addWidget(section)
        self.column.addWidget(self._body)
        self._body_map = character_section(self, lambda: self.entity.character_id, self.remap_requested.emit)
        self.column.addWidget(self._body_map)
        self.finish()

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for the performer itself and for all characters, which the form lists."""
        return super().depends_on(collection, entity_id) or collection == "characters"

    def refresh(self) -> None:
        """Update all fields from the document."""
        performer = self.entity
        if performer is None:
            return
        with QSignalBlocker(self._visible):
            self._visible.setChecked(performer.visible)
        with QSignalBlocker(self._limited):
            self._limited.setChecked(performer.limited)
        with QSignalBlocker(self._eased):
            self._eased.setChecked(performer.eased)
        with QSignalBlocker(self._clears):
            self._clears.setChecked(performer.clears)
        self._name.show_name()
        self._cast.clear_all()
        for key, each in self.document.project.characters.items():
            self._cast.add(key, each.name)
        self._cast.show_value(performer.character_id)
        motions = self.document.project.motions
        self._plays.setText(", ".join(motions[clip.motion_id].name for clip in performer.clips) or "none")
        self._x.show_value(performer.position[0])
        self._y.show_value(performer.position[1])
        self._heading.show_value(math.degrees(performer.heading))
        self._body.refresh()
        self._body_map.refresh()

    def _show_or_hide(self, visible: bool) -> None:
        self.change(f"{'Show' if visible else 'Hide'} {self.entity.name}", visible=visible)

    def _limit_or_free(self, limited: bool) -> None:
        self.change(f"{'Enable' if limited else 'Disable'} joint limits of {self.entity.name}", limited=limited)

    def _ease_or_not(self, eased: bool) -> None:
        self.change(f"{'Enable' if eased else 'Disable'} smoothing of {self.entity.name}", eased=eased)

    def _clear_or_not(self, clears: bool) -> None:
        kept = "Enable arm self-collision" if clears else "Disable arm self-collision"
        self.change(f"{kept} of {self.entity.name}", clears=clears)

    def _recast(self, character_id: str) -> None:
        """Replace the performer's character; the performer takes the new name unless the user has renamed it."""
        characters = self.document.project.characters
        new, old = characters[character_id], characters[self.entity.character_id]
        name = new.name if self.entity.name == old.name else self.entity.name
        self.change(f"Set character of {self.entity.name} to {new.name}", character_id=character_id, name=name)

    def _mover(self, axis: int) -> Callable[[float], None]:
        def move(metres: float) -> None:
            place = list(self.entity.position)
            place[axis] = metres
            self.change(f"Move {self.entity.name}", position=tuple(place))

        return move

    def _turn(self, degrees: float) -> None:
        self.change(f"Rotate {self.entity.name}", heading=math.radians(degrees))
