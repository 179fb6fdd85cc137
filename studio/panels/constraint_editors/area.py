"""Form of a volume constraint: shape, position, size, and the side on which the point must be."""

import math
from functools import partial

import numpy as np

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.curves.keyed import KeyedTurn, Quaternion
from studio.core.rotations import from_euler, to_euler
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.target_rows import KeyRow, NumberRows, TargetRows
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Choice, NumberField, Section, Segments, check_box

SHAPE_CHOICES = (
    (AreaShape.TABLE, "Table top"),
    (AreaShape.BOX, "Box"),
    (AreaShape.SPHERE, "Sphere"),
    (AreaShape.CYLINDER, "Cylinder"),
    (AreaShape.HALF_SPACE, "Half-space"),
)
MESH_CHOICE = (AreaShape.MESH, "Mesh")
"""Choice that is offered only if the constraint has a mesh, which is loaded from a file."""
SIZE_FIELDS = {
    AreaShape.SPHERE: ("Diameter", "m", (True, False, False)),
    AreaShape.CYLINDER: ("Width, height", "m", (True, False, True)),
    AreaShape.HALF_SPACE: ("Normal", "", (True, True, True)),
    AreaShape.MESH: ("", "", (False, False, False)),
}
"""Label, unit, and use of the three components of the size by shape; other shapes have the edge lengths of a box."""
SHAPES_WITH_HEADING = (AreaShape.TABLE, AreaShape.BOX, AreaShape.MESH)
SHAPES_WITH_TILT = (*SHAPES_WITH_HEADING, AreaShape.CYLINDER)
MIN_AREA_SIZE_METRES = 0.001
DEFAULT_HALF_SPACE_NORMAL, DEFAULT_AREA_SIZE = (0.0, 0.0, 1.0), (1.0, 1.0, 1.0)


class AreaEditor(ConstraintEditor[AreaConstraint]):
    """Form of a volume constraint; it shows only the values that the shape has."""

    kind_words = "volume"

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of shape, region, centre, size, margin, heading and tilt."""
        self._shape = Choice("Shape", SHAPE_CHOICES)
        self._shape.value_chosen.connect(self._set_shape)
        section.add_row("Shape", self._shape)
        self._side = Segments("Region", [("outside", "Outside"), ("inside", "Inside"), ("on", "Surface")])
        self._side.value_chosen.connect(self._set_side)
        section.add_row("Region", self._side)
        self._whole = check_box("Include limbs and torso")
        self._whole.setAccessibleName("Keep all limbs and the torso out, not only the point")
        self._whole.clicked.connect(self._set_whole)
        section.add_row("Collision", self._whole)
        self._source = TargetRows(self, section, "centre")
        self._centre = VectorRow(self, section, "Centre", self._set_centre)
        self._size = VectorRow(self, section, "Size", self._set_size)
        self._margin = self.bind(NumberField("Margin", "m", 0.0, 10.0, 0.01, 3), self._set_margin)
        self._margin_caption = section.add_row("Margin", self._margin)
        self._heading = self.bind(NumberField("Heading", "°", -360.0, 360.0, 1.0, 1), self._set_heading)
        self._direction = NumberRows(self, section, "heading")
        self._heading_caption = section.add_row("Heading", self._heading, self._direction.keyed)
        self._tilts = [
            self.bind(NumberField(f"Tilt {axis}", "°", -180.0, 180.0, 1.0, 1), partial(self._set_tilt, index))
            for index, axis in enumerate("XY")
        ]
        for field in self._tilts:
            field.setToolTip("Rotation about X, then about Y, in degrees; the heading comes last.")
        self._tilt_keyed = check_box("keyed")
        self._tilt_keyed.setAccessibleName("Tilt is animated")
        self._tilt_keyed.clicked.connect(self._key_tilt)
        self._tilt_caption = section.add_row("Tilt", *self._tilts, self._tilt_keyed)
        self._tilt_keys = KeyRow(self, section, "tilt")

    def refresh(self) -> None:
        """Update all fields from the document."""
        super().refresh()
        area = self.entity
        if area is None:
            return
        if area.mesh is not None and not self._shape.offers(AreaShape.MESH):
            self._shape.add(*MESH_CHOICE)
        self._shape.show_value(area.shape)
        self._side.show_value("on" if area.on_surface else "inside" if area.inside else "outside")
        self._whole.setChecked(area.whole)
        self._whole.setEnabled(not (area.inside or area.on_surface))
        words, unit, used = SIZE_FIELDS.get(area.shape, ("Size", "m", (True, True, True)))
        self._size.set_unit(words, unit)
        self._size.set_least(-1.0 if area.shape is AreaShape.HALF_SPACE else MIN_AREA_SIZE_METRES)
        self._size.show_values(area.size)
        self._size.set_visible(*used)
        self._margin.show_value(area.margin)
        for widget in (self._margin, self._margin_caption):
            widget.setVisible(not (area.inside or area.on_surface))

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        turned = self.entity.shape in SHAPES_WITH_HEADING
        self._source.refresh()
        now = self._source.current_numbers()
        if now is not None:
            self._centre.show_values(now)
        self._direction.refresh(turned)
        self._heading.show_value(math.degrees(self._direction.current_number))
        tilted = self.entity.shape in SHAPES_WITH_TILT
        for field, radians in zip(self._tilts, to_euler("ZYX", np.array(self._tilt_now()))[:0:-1], strict=True):
            field.show_value(math.degrees(radians))
        self._tilt_keyed.setChecked(isinstance(self.entity.tilt, KeyedTurn))
        for widget, visible in (
            (self._heading, turned),
            (self._heading_caption, turned),
            (self._tilt_caption, tilted),
            (self._tilt_keyed, tilted),
            *((field, tilted) for field in self._tilts),
        ):
            widget.setVisible(visible)
        self._tilt_keys.refresh(tilted)

    def _set_centre(self, position: tuple[float, ...]) -> None:
        self._source.set_numbers(position, f"Move {self.entity.name}")

    def _set(self, verb: str, **values: object) -> None:
        self.change(f"{verb} {self.entity.name}", **values)

    def _set_whole(self, whole: bool) -> None:
        self._set("Set collision of", whole=whole)

    def _set_side(self, side: str) -> None:
        outside: dict[str, object] = {} if side == "outside" else {"whole": False, "margin": 0.0}
        self._set("Set region of", inside=side == "inside", on_surface=side == "on", **outside)

    def _set_margin(self, metres: float) -> None:
        self._set("Set margin of", margin=metres)

    def _set_size(self, size: tuple[float, ...]) -> None:
        self._set("Resize", size=size)

    def _set_shape(self, shape: AreaShape) -> None:
        """Set the shape. A half-space stores its normal as size, so the size is reset."""
        old = self.entity.shape
        size = self.entity.size
        if shape is not old and AreaShape.HALF_SPACE in (shape, old):
            size = DEFAULT_HALF_SPACE_NORMAL if shape is AreaShape.HALF_SPACE else DEFAULT_AREA_SIZE
        self._set("Set shape of", shape=shape, size=size)

    def _tilt_now(self) -> Quaternion:
        """Tilt (x, y, z, w) at the playhead."""
        tilt = self.entity.tilt
        return tilt.value_at(self._tilt_keys.now) if isinstance(tilt, KeyedTurn) else tilt

    def _set_tilt(self, axis: int, degrees: float) -> None:
        angles, tilt = to_euler("ZYX", np.array(self._tilt_now())), self.entity.tilt
        angles[2 - axis] = math.radians(degrees)
        x, y, z, w = from_euler("ZYX", angles).tolist()
        now = self._tilt_keys.now
        self._set("Rotate", tilt=tilt.with_key(now, (x, y, z, w)) if isinstance(tilt, KeyedTurn) else (x, y, z, w))

    def _key_tilt(self, keyed: bool) -> None:
        tilt = self._tilt_now()
        words = "Key tilt of" if keyed else "Delete keys of the tilt of"
        self._set(words, tilt=KeyedTurn((self._tilt_keys.now,), (tilt,)) if keyed else tilt)

    def _set_heading(self, degrees: float) -> None:
        self._direction.set_number(math.radians(degrees), f"Rotate {self.entity.name}")
