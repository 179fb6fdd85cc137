"""Form of a saved camera: its name, its shortcut, and its placement."""

import math

from studio.core.changed_records import with_fields
from studio.core.stage.saved_camera import CAMERA_SLOTS, SavedCamera
from studio.document.document import Document
from studio.document.stored_cameras import give_slot
from studio.engine.live_interface import Live
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import Choice, NumberField, Section, check_box

NO_SLOT = "none"


class CameraEditor(Editor[SavedCamera]):
    """Form of a saved camera."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Camera")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._slot = Choice("Shortcut", [(NO_SLOT, "None"), *((str(slot), f"Camera {slot}") for slot in CAMERA_SLOTS)])
        self._slot.value_chosen.connect(
            lambda slot: give_slot(document, entity_id, None if slot == NO_SLOT else int(slot))
        )
        section.add_row("Shortcut", self._slot)
        self._target = VectorRow(self, section, "Target", lambda target: self._place(target=target))
        self._distance = self.bind(
            NumberField("Distance", "m", 0.15, 150.0, 0.1, 2), lambda value: self._place(distance=value)
        )
        section.add_row("Distance", self._distance)
        self._azimuth = self.bind(
            NumberField("Azimuth", "°", -3600.0, 3600.0, 5.0, 1), lambda value: self._place(azimuth=math.radians(value))
        )
        section.add_row("Azimuth", self._azimuth)
        self._elevation = self.bind(
            NumberField("Elevation", "°", -90.0, 90.0, 5.0, 1), lambda value: self._place(elevation=math.radians(value))
        )
        section.add_row("Elevation", self._elevation)
        self._parallel = check_box("Orthographic")
        self._parallel.clicked.connect(lambda on: self._place(parallel=on))
        section.add_wide(self._parallel)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Show the saved camera."""
        camera = self.entity
        placement = camera.placement
        self._name.show_name()
        self._slot.show_value(str(camera.slot) if camera.slot else NO_SLOT)
        self._target.show_values(placement.target)
        self._distance.show_value(placement.distance)
        self._azimuth.show_value(math.degrees(placement.azimuth))
        self._elevation.show_value(math.degrees(placement.elevation))
        self._parallel.setChecked(placement.parallel)

    def _place(self, **values: object) -> None:
        self.change(f"Move {self.entity.name}", placement=with_fields(self.entity.placement, **values))
