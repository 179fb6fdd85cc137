"""Form of a capture with its import report: facts of the file, guesses with their reasons, and repairs."""

from collections.abc import Callable
from dataclasses import replace
from html import escape

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from studio.core.captures.capture import Capture, Guess
from studio.core.captures.remarks import remarks_on
from studio.core.stage.project import Motion
from studio.document import colours
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.body_map_section import capture_section
from studio.panels.editor import Editor
from studio.panels.fields import Choice, NumberField, Section, TagField, press_button, styled_label
from studio.panels.reference_figure import ReferenceFigure

UNIT_CHOICES = (
    *(("m", "metres"), ("dm", "decimetres"), ("cm", "centimetres"), ("mm", "millimetres")),
    *(("inch", "inches"), ("foot", "feet"), ("cmu", "CMU (5.64 cm)")),
)
REFERENCES = (("zero", "All rotations zero"), ("here", "Frame at the playhead"))
UP_AXIS_CHOICES = tuple((axis, f"{axis} up") for axis in ("X", "Y", "Z", "-X", "-Y", "-Z"))


class CaptureEditor(Editor[Capture]):
    """Form of a capture: facts of the file, import settings and report. Changing unit or up axis reads the file
    again.
    """

    reimport_requested = Signal(str, object)
    """Emitted with the capture's id and {option: value} to import with other settings."""
    markers_requested = Signal(str)
    """Emitted with the capture's id to open its markers."""
    character_requested = Signal(str)
    """Emitted with the capture's id to create a character from its actor."""

    steps_requested = Signal(str)
    """Emitted with the capture's id to make the steps that were detected the ground."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        self._facts = Section("Capture")
        self._actor = press_button("Create character", lambda: self.character_requested.emit(self.entity_id))
        self._actor.setToolTip("Create a character with the actor's exact proportions")
        self._facts.head.addWidget(self._actor)
        self._values = {name: styled_label("", "value") for name in ("File", "Frames", "Length", "Joints")}
        for name, value in self._values.items():
            self._facts.add_row(name, value)
        self._tags = TagField("walk, fast", "used by the outliner's search")
        self._tags.tags_edited.connect(self._set_tags)
        self._facts.add_row("Tags", self._tags)
        self.column.addWidget(self._facts)
        self._add_options()
        self._markers = styled_label("", "value")
        self._markers.setWordWrap(True)
        open_markers = press_button("Open…", lambda: self.markers_requested.emit(self.entity_id), "link")
        open_markers.setAccessibleName("Open markers")
        self._marker_section = Section("Markers")
        self._marker_section.head.addWidget(open_markers)
        self._marker_section.add_row("Marker map", self._markers)
        self.column.addWidget(self._marker_section)
        self._report: QWidget | None = None
        self._body_map = capture_section(self)
        self.column.addWidget(self._body_map)
        self.finish()

    def _add_options(self) -> None:
        section = Section("Import settings")
        self._unit = Choice("Unit", UNIT_CHOICES)
        self._unit.value_chosen.connect(lambda unit: self._ask(unit=unit))
        self._axis = Choice("Up axis", UP_AXIS_CHOICES)
        self._axis.value_chosen.connect(lambda axis: self._ask(up_axis=axis))
        self._reference = Choice("Reference pose", REFERENCES)
        self._reference.setPlaceholderText("Detected")
        self._reference.value_chosen.connect(self._ask_reference)
        self._rate = self.bind(
            NumberField("Frame rate", "fps", 1.0, 1000.0, 1.0, 3),
            self._changer("Set frame rate", lambda capture, value: capture.with_frame_rate(value)),
        )
        self._floor = self.bind(
            NumberField("Floor", "m", -10.0, 10.0, 0.005, 3),
            self._changer("Set floor", lambda capture, value: capture.with_floor(value)),
        )
        self._first = self.bind(
            NumberField("First frame", "", 0, 1e6, 1, 0),
            self._changer("Set first frame", lambda capture, value: capture.with_first_frame(round(value))),
        )
        for label, field in (
            ("Unit", self._unit),
            ("Up axis", self._axis),
            ("Reference pose", self._reference),
            ("Frame rate", self._rate),
            ("Floor", self._floor),
            ("First frame", self._first),
        ):
            section.add_row(label, field)
        self.column.addWidget(section)

    def refresh(self) -> None:
        """Update facts, settings and report."""
        capture: Capture | None = self.entity
        if capture is None:
            return
        facts = (
            capture.source,
            f"{capture.frame_count} at {capture.frame_rate:.5g} fps",
            f"{capture.duration:.2f} s",
            f"{capture.skeleton.joint_count}",
        )
        for label, text in zip(self._values.values(), facts, strict=True):
            label.setText(text)
        self._tags.show_tags(next((each.tags for each in self._motions.values()), ()))
        self._tags.setEnabled(bool(self._motions))
        self._actor.setEnabled(capture.body_map is not None)
        self._reference.show_value(None)
        _show(self._unit, capture.unit)
        _show(self._axis, capture.up_axis)
        self._rate.show_value(capture.frame_rate)
        self._floor.show_value(capture.floor)
        self._first.show_value(capture.first_frame)
        self._body_map.refresh()
        self._marker_section.setVisible(capture.markers is not None)
        if capture.markers is not None:
            self._markers.setText(capture.markers.marker_map.name)
        self._show_report(capture)

    @property
    def _motions(self) -> dict[str, Motion]:
        """Motions of the capture by id; their tags are shown as those of the capture."""
        motions = self.document.shown_project.motions.items()
        return {key: motion for key, motion in motions if motion.capture_id == self.entity_id}

    def _set_tags(self, tags: tuple[str, ...]) -> None:
        text = f"Set tags of {self.entity.name}"
        with self.document.group(text):
            for key, motion in self._motions.items():
                self.document.replace("motions", key, replace(motion, tags=tags), text)

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for the capture itself, and for motions, whose tags the form shows."""
        return collection == "motions" or super().depends_on(collection, entity_id)

    def _show_report(self, capture: Capture) -> None:
        report = self._make_report(capture)
        if self._report is None:
            self.column.insertWidget(2, report)
        else:
            self.column.replaceWidget(self._report, report)
            self._report.deleteLater()
        self._report = report

    def _make_report(self, capture: Capture) -> QWidget:
        """Section with the guesses and their reasons, repairs, and warnings."""
        section = Section(f"Assumptions · {len(capture.guesses)}")
        for guess in capture.guesses:
            section.add_wide(_guess_lines(guess))
            if guess.subject == "cleaning":
                section.add_wide(press_button("Clean up motion", lambda: self._ask(clean=True)))
            if guess.subject == "steps":
                section.add_wide(press_button("Use steps as ground", lambda: self.steps_requested.emit(self.entity_id)))
        if capture.body_map is not None:
            section.add_wide(ReferenceFigure(capture, capture.body_map))
        if not capture.guesses:
            section.add_wide(styled_label("No assumptions were made.", "hint"))
        for repair in capture.repairs:
            section.add_wide(styled_label(f"Repaired: {repair}", "hint"))
        for remark in remarks_on(capture):
            section.add_wide(styled_label(f"Warning: {remark.sentence}", "hint"))
        return section

    def _changer(self, text: str, make: Callable[[Capture, float], Capture]) -> Callable[[float], None]:
        return lambda value: self.replace_entity(lambda: make(self.entity, value), f"{text} of {self.entity.name}")

    def _ask_reference(self, which: str) -> None:
        self._ask(reference="zero" if which == "zero" else str(self.document.playhead.frame))

    def _ask(self, **option: object) -> None:
        self.reimport_requested.emit(self.entity_id, option)
        self.refresh()


def _show(choice: Choice, value: str) -> None:
    if not choice.offers(value):
        choice.add(value, value)
    choice.show_value(value)


def _guess_lines(guess: Guess) -> QWidget:
    line = styled_label("", "hint")
    head = guess.title[:1].upper() + guess.title[1:]
    line.setText(f'<span style="color: {colours.TEXT}">{escape(head)}</span><br>{escape(guess.reason)}')
    return line
