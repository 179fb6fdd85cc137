"""The form of a balance constraint: over what the centre of mass is to be."""

from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.present import mass_now
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Section, Segments


class BalanceEditor(ConstraintEditor):
    """The motion's own place, or one on the ground."""

    has_point = False

    def add_kind_rows(self, section: Section) -> None:
        """Own or fixed, and the place if it is fixed."""
        self._mode = Segments("Centre of mass", [(False, "Own place"), (True, "Fixed place")])
        self._mode.chosen.connect(self._set_fixed)
        section.add_row("Mass over", self._mode)
        self._place = VectorRow(self, section, "Place", self._set_place, "XY")

    def refresh(self) -> None:
        """Fetch everything."""
        super().refresh()
        if self.entity is None:
            return
        place = self.entity.place
        self._mode.show_value(place is not None)
        self._place.set_visible(*[place is not None] * 2)
        if place is not None:
            self._place.show_values(place)

    def _set_fixed(self, fixed: bool) -> None:
        """A fixed place begins where the active body's centre of mass is now."""
        if fixed == (self.entity.place is not None):
            return
        place = (mass_now(self) or (0.0, 0.0, 0.0))[:2] if fixed else None
        self.change(f"{'Fix' if fixed else 'Free'} place of {self.entity.name}", place=place)

    def _set_place(self, place: tuple[float, ...]) -> None:
        self.change(f"Move place of {self.entity.name}", place=place)
