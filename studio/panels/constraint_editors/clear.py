"""Form of an arm clearance constraint: arms, margin, and the joints that may move."""

from dataclasses import replace

from studio.core.constraints.clear import Arms, ClearConstraint
from studio.panels.constraint_editors.common import CENTIMETRE, ConstraintEditor
from studio.panels.fields import NumberField, Section, Segments, styled_label

ARM_CHOICES = ((Arms.BOTH, "Both"), (Arms.LEFT, "Left"), (Arms.RIGHT, "Right"))


class ClearEditor(ConstraintEditor[ClearConstraint]):
    """Form of an arm clearance constraint. It has neither point nor IK chain, since it always concerns whole arms."""

    has_point = has_chain = False
    kind_words = "arm clearance"

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of arms, margin and movable joints."""
        self._arms = Segments("Arms", ARM_CHOICES)
        self._arms.value_chosen.connect(lambda arms: self.change(f"Set arms of {self.entity.name}", arms=arms))
        section.add_row("Arms", self._arms)
        self._margin = self.bind(NumberField("Margin", "cm", 0.0, 50.0, 0.5, 1), self._set_margin)
        self._margin.setToolTip(
            "Minimum distance between arms and body, for example for thick clothing; applies at self-contacts too"
        )
        section.add_row("Margin", self._margin)
        self._gives = Segments("May move", [(True, "Wrist, elbow"), (False, "Elbow")])
        self._gives.value_chosen.connect(self._set_gives)
        section.add_row("May move", self._gives)
        section.add_wide(styled_label("Self-contacts of the actor are kept.", "hint"))

    def refresh(self) -> None:
        """Update all fields from the document."""
        super().refresh()
        if self.entity is None:
            return
        self._arms.show_value(self.entity.arms)
        self._margin.show_value(self.entity.margin / CENTIMETRE)
        self._gives.show_value(self.entity.chain.limb > 0.0)

    def _set_margin(self, centimetres: float) -> None:
        self.change(f"Set margin of {self.entity.name}", margin=centimetres * CENTIMETRE)

    def _set_gives(self, wrist: bool) -> None:
        chain = replace(self.entity.chain, limb=float(wrist))
        self.change(f"Set movable parts for {self.entity.name}", chain=chain)
