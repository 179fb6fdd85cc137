"""Form of a balance constraint: the target of the centre of mass."""

from studio.core.constraints.balance import BalanceConstraint, Support
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.present import current_centre_of_mass
from studio.panels.constraint_editors.target_rows import TargetRows
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import NumberField, Section, Segments, check_box

OWN_BALANCE, PLACE_BALANCE, SUPPORT_BALANCE = "own", "place", "support"
MARGIN_UNIT_METRES = 0.01
MAX_MARGIN_CENTIMETRES = 10.0


class BalanceEditor(ConstraintEditor[BalanceConstraint]):
    """Form of a balance constraint: the centre of mass stays where it was captured, over a position, or over the
    support polygon.
    """

    has_point = False

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of the target, its position, the margin of a support, and the height."""
        self._mode = Segments(
            "Centre of mass",
            [(OWN_BALANCE, "As captured"), (PLACE_BALANCE, "Position"), (SUPPORT_BALANCE, "Support polygon")],
        )
        self._mode.value_chosen.connect(self._set_mode)
        section.add_row("Balance over", self._mode)
        self._source = TargetRows(self, section, "place")
        self._place = VectorRow(self, section, "Position", self._set_place)
        self._margin = self.bind(NumberField("Margin", "cm", 0.0, MAX_MARGIN_CENTIMETRES, 0.5, 1), self._set_margin)
        self._margin_caption = section.add_row("Margin", self._margin)
        self._vertical = check_box("Constrain height")
        self._vertical.setAccessibleName("Constrain the height of the centre of mass too")
        self._vertical.clicked.connect(self._set_vertical)
        section.add_row("Height", self._vertical)

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        place = self.entity.place
        mode = OWN_BALANCE if place is None else SUPPORT_BALANCE if isinstance(place, Support) else PLACE_BALANCE
        self._mode.show_value(mode)
        self._source.refresh()
        now = self._source.current_numbers() if mode == PLACE_BALANCE else None
        height = mode == PLACE_BALANCE and len(now or ()) == 3
        self._place.set_visible(mode == PLACE_BALANCE, mode == PLACE_BALANCE, height)
        if now is not None:
            self._place.show_values((*now, 0.0)[:3])
        for widget in (self._margin, self._margin_caption):
            widget.setVisible(mode == SUPPORT_BALANCE)
        if isinstance(place, Support):
            self._margin.show_value(place.margin / MARGIN_UNIT_METRES)
        self._vertical.setChecked(self.entity.vertical)

    def _set_mode(self, mode: str) -> None:
        """Set the kind of target; a new position is the active performer's current centre of mass."""
        now = (current_centre_of_mass(self) or (0.0, 0.0, 0.0))[:2]
        place = {OWN_BALANCE: None, PLACE_BALANCE: now, SUPPORT_BALANCE: Support()}[mode]
        self.change(f"Set position of {self.entity.name}", place=place)

    def _set_place(self, position: tuple[float, ...]) -> None:
        flat = isinstance(self.entity.place, tuple) and len(self.entity.place) == 2
        self._source.set_numbers(position[:2] if flat else position, f"Move position of {self.entity.name}")

    def _set_margin(self, centimetres: float) -> None:
        self.change(f"Set margin of {self.entity.name}", place=Support(centimetres * MARGIN_UNIT_METRES))

    def _set_vertical(self, vertical: bool) -> None:
        self.change(f"{'Constrain' if vertical else 'Free'} height of {self.entity.name}", vertical=vertical)
