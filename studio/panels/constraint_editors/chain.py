"""Form section of the IK chain: a figure whose segments can be locked or freed, and a weight for each group of
segments.
"""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.changed_records import with_fields
from studio.core.constraints.base import CHAIN_LINKS, Constraint
from studio.panels.constraint_editors.body_figure import BodyFigure
from studio.panels.constraint_editors.segment_weights import SegmentWeights, weight_field
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, styled_label

TRUNK_SEGMENTS = (BodyPart.ABDOMEN, BodyPart.THORAX)


def link_words(point: BodyPart) -> dict[str, str]:
    """Label of each group of segments in the IK chain of a constraint on the part ``point``."""
    side, _, bone = point.value.partition("_")
    if bone in ("clavicle", "upper_arm", "forearm", "hand"):
        names = (f"{side.capitalize()} arm", f"{side.capitalize()} hand", f"{side.capitalize()} clavicle")
    elif bone in ("thigh", "shank", "foot", "toe"):
        names = (f"{side.capitalize()} leg", f"{side.capitalize()} foot", "Clavicle")
    else:
        names = ("Neck, head", "End segment", "Clavicle")
    return dict(zip(CHAIN_LINKS, (*names, "Torso", "Pelvis, root", "Other arms", "Other legs"), strict=True))


def link_parts(constraint: Constraint) -> dict[str, tuple[BodyPart, ...]]:
    """Segments of each group in the IK chain that affect a constraint."""
    side, _, bone = constraint.point.part.value.partition("_")
    links: dict[str, tuple[BodyPart, ...]] = {"trunk": TRUNK_SEGMENTS, "root": (BodyPart.PELVIS,)}
    if bone in ("clavicle", "upper_arm", "forearm", "hand"):
        links["limb"] = (BodyPart(f"{side}_upper_arm"), BodyPart(f"{side}_forearm"))
        links["end_segment"] = (BodyPart(f"{side}_hand"),)
        links["clavicle"] = (BodyPart(f"{side}_clavicle"),)
    elif bone in ("thigh", "shank", "foot", "toe"):
        del links["trunk"]  # it stands above the hips
        links["limb"] = (BodyPart(f"{side}_thigh"), BodyPart(f"{side}_shank"))
        links["end_segment"] = (BodyPart(f"{side}_foot"),)
    else:
        links["limb"] = (BodyPart.HEAD,)
    if constraint.kind == "balance":
        links["free_arms"] = _both("upper_arm", "forearm", "hand")
        links["free_legs"] = _both("thigh", "shank", "foot")
    return links


def _both(*bones: str) -> tuple[BodyPart, ...]:
    return tuple(BodyPart(f"{side}_{bone}") for side in ("left", "right") for bone in bones)


class ChainSection(Section):
    """Form section with a figure whose segments are locked or freed by a click, and their weights beside it."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__("IK chain")
        self._editor = editor
        self._figure = BodyFigure()
        self._figure.clicked.connect(self._toggle)
        self._names: dict[str, QLabel] = {}
        self._weights: dict[str, NumberField] = {}
        row = QWidget()
        line = QHBoxLayout(row)
        line.setContentsMargins(0, 0, 0, 0)
        line.setSpacing(12)
        line.addWidget(self._figure)
        line.addLayout(self._make_weights(), 1)
        self.add_wide(row)
        self._segments = SegmentWeights(editor)
        self.add_wide(self._segments)

    def _make_weights(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        for index, link in enumerate(CHAIN_LINKS):
            name = styled_label("", "second")
            field = weight_field("Weight")
            self._editor.bind(field, self._setter(link))
            grid.addWidget(name, index, 0)
            grid.addWidget(field, index, 1)
            self._names[link], self._weights[link] = name, field
        grid.setRowStretch(len(CHAIN_LINKS) + 1, 1)
        return grid

    def refresh(self) -> None:
        """Update weights and labels."""
        constraint = self._editor.entity
        part, chain = constraint.point.part, constraint.chain
        parts = link_parts(constraint)
        for link, words in link_words(part).items():
            self._names[link].setText(words)
            self._names[link].setVisible(link in parts)
            self._weights[link].setVisible(link in parts)
            self._weights[link].setAccessibleName(f"Weight of {words}")
            self._weights[link].show_value(getattr(chain, link))
        weights = {segment: getattr(chain, link) for link, many in parts.items() for segment in many}
        own: dict[BodyPart, float] = {
            segment: weight for segment, weight in chain.segments if segment != BodyPart.PELVIS
        }
        self._figure.show_weights(
            {segment: own.get(segment, weight) for segment, weight in weights.items()}, constraint.point
        )
        self._segments.refresh()

    def _setter(self, link: str) -> Callable[[float], None]:
        return lambda weight: self._set(link, weight)

    def _set(self, link: str, weight: float) -> None:
        editor = self._editor
        words = link_words(editor.entity.point.part)[link].lower()
        editor.replace_entity(
            lambda: replace(editor.entity, chain=with_fields(editor.entity.chain, **{link: weight})),
            f"Set weight of {words} for {editor.entity.name}",
        )

    def _toggle(self, part: BodyPart) -> None:
        own = dict(self._editor.entity.chain.segments)
        if part in own and part != BodyPart.PELVIS:  # the figure's pelvis is the root
            self._segments.put(part, 0.0 if own[part] > 0.0 else 1.0)
            return
        links = link_parts(self._editor.entity)
        link = next(link for link, parts in links.items() if part in parts)
        self._set(link, 0.0 if getattr(self._editor.entity.chain, link) > 0.0 else 1.0)
