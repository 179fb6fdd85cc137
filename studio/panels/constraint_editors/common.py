"""Base form of all kinds of constraint: name, point, activation, IK chain, priority, residuals."""

from dataclasses import replace
from functools import partial
from typing import Generic, TypeVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.scope import Scope
from studio.core.constraints.target import is_moving
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.engine.point_names import POINT_NAMES, point_words
from studio.panels.constraint_editors.activation import ActivationSection
from studio.panels.constraint_editors.chain import ChainSection
from studio.panels.constraint_editors.priority import PrioritySection
from studio.panels.constraint_editors.worst_residuals import ResidualSection
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import Choice, NumberField, Section, check_box, with_unit
from studio.panels.scope_row import ScopeRow

CENTIMETRE = 0.01


def point_choices() -> list[tuple[object, str]]:
    """All named points of the body with their labels."""
    return [(point, name.capitalize()) for point, name in POINT_NAMES.items()]


ConstraintT_co = TypeVar("ConstraintT_co", bound=Constraint, covariant=True)


class ConstraintEditor(Editor[ConstraintT_co], Generic[ConstraintT_co]):
    """Form of a constraint; subclasses add the rows of their kind in ``add_kind_rows``."""

    has_point = True
    """True if the kind constrains a point, and the form has rows for it."""
    kind_words = ""
    """Name of the kind in the title; empty to use the name in ``kind``."""
    has_chain = True
    """True if the form has a section for the IK chain."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        kind = self.kind_words or self.entity.kind.replace("_", "-")
        self._section = Section(f"{kind.capitalize()} constraint")
        self._add_names()
        self._scope = ScopeRow(self, self._section, self._ask)
        self._add_point()
        self.add_kind_rows(self._section)
        self._activation = ActivationSection(self)
        self._chain = ChainSection(self)
        self._residuals = ResidualSection(self)
        self._priority = PrioritySection(self)
        document.playhead.changed.connect(self._playhead_moved)
        for section in (self._section, self._residuals, self._activation, self._chain, self._priority):
            self.column.addWidget(section)
        self._chain.setVisible(self.has_chain)
        self.finish()

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of this kind to the section."""

    def _add_names(self) -> None:
        self._enabled = check_box("on")
        self._enabled.setAccessibleName("Constraint enabled")
        self._enabled.toggled.connect(self._set_enabled)
        self._section.head.addWidget(self._enabled)
        self._name = EntityNameField(self)
        self._section.add_row("Name", self._name)

    def _add_point(self) -> None:
        self._point = Choice("Point", point_choices())
        self._point.setToolTip("Constrained point. You can also click a joint in the 3D view and press C.")
        self._point.value_chosen.connect(self._set_point)
        caption = self._section.add_row("Point", self._point)
        self._offset = [
            self.bind(
                NumberField(f"Offset {axis}", "cm", -100.0, 100.0, 0.5, 1, suffix=False),
                partial(self._set_offset, k),
            )
            for k, axis in enumerate("XYZ")
        ]
        offset_caption = self._section.add_row(with_unit("Offset", "cm"), *self._offset)
        if not self.has_point:
            for widget in (caption, self._point, offset_caption, *self._offset):
                widget.hide()

    def refresh(self) -> None:
        """Update all fields from the document."""
        constraint = self.entity
        if constraint is None:
            return
        self._enabled.blockSignals(True)
        self._enabled.setChecked(constraint.enabled)
        together = [self.document.project.constraints[key] for key in self.edited_ids]
        self._enabled.setText("on" if len({each.enabled for each in together}) == 1 else "on (mixed)")
        self._enabled.blockSignals(False)
        self._name.show_name()
        self._scope.refresh()
        self._show_point(constraint.point)
        for field, value in zip(self._offset, constraint.point.offset, strict=True):
            field.show_value(value / CENTIMETRE)
        for section in (self._activation, self._chain, self._residuals, self._priority):
            section.refresh()
        self.refresh_moment()

    def refresh_moment(self) -> None:
        """Update values that change over time: targets that are keyed or follow an object."""

    def _playhead_moved(self, _: float) -> None:
        if self.entity is None:
            return
        self._activation.refresh_clip()
        if is_moving(self.entity):
            self.refresh_moment()
            self._priority.refresh_weight()

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for constraints, because of the order of priorities, for performers and characters, which the residuals
        name, and for props, which targets name.
        """
        return collection in ("constraints", "performers", "characters", "props")

    def _show_point(self, point: BodyPoint) -> None:
        if not self._point.offers((point.part, point.at_end)):
            self._point.add((point.part, point.at_end), point_words(point).capitalize())
        self._point.show_value((point.part, point.at_end))

    def _ask(self, scope: Scope) -> None:
        self.change(f"Set 'Applies to' of {self.entity.name}", scope=scope)

    def _set_enabled(self, enabled: bool) -> None:
        self.change(f"{'Enable' if enabled else 'Disable'} {self.entity.name}", enabled=enabled)

    def _set_point(self, choice: tuple[BodyPart, bool]) -> None:
        point = BodyPoint(choice[0], at_end=choice[1])
        self.change(f"Set point of {self.entity.name}", point=point)

    def _set_offset(self, axis: int, centimetres: float) -> None:
        point = self.entity.point
        x, y, z = (centimetres * CENTIMETRE if k == axis else each for k, each in enumerate(point.offset))
        point = replace(point, offset=(x, y, z))
        self.change(f"Move point of {self.entity.name}", point=point)
