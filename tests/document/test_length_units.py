"""Units of lengths: one choice of the preferences for texts, fields and curves, the same lengths in the document."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.core.curves.keyed import KeyedPlace
from studio.document.channels import channels_of, key_values, with_values
from studio.document.document import Document
from studio.document.keyed_fields import KeyedField
from studio.document.length_units import LENGTH_CHOICES, length_text, shown_unit, use_lengths
from studio.engine.residual_measures import ANGLE_MEASURE, LENGTH_MEASURE
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from tests.builders import make_project
from tests.panels.test_inspector import named
from tests.solved_live import SolvedLive


@pytest.fixture
def lengths():
    """Function that chooses units, which are the usual ones again after the test."""
    yield use_lengths
    use_lengths("usual")


TEXTS = {
    "usual": ("1.66 m", "+2.5 cm", "0.4 mm", "42 mm", "1.20 m", "cm/s"),
    "m": ("1.66 m", "+0.025 m", "0.4 mm", "42 mm", "1.20 m", "m/s"),
    "cm": ("166 cm", "+2.5 cm", "0.4 mm", "42 mm", "120 cm", "cm/s"),
    "in": ("65.4 in", "+0.98 in", "0.016 in", "1.65 in", "47.2 in", "in/s"),
}


@pytest.mark.parametrize("choice", LENGTH_CHOICES)
def test_the_same_length_is_told_in_the_unit_that_is_chosen(lengths, choice):
    lengths(choice)
    words = LENGTH_MEASURE.text_of
    texts = length_text(1.66, "m", 2), length_text(0.025, "cm", 1, "+"), words(0.0004), words(0.042), words(1.2)
    assert (*texts, shown_unit("cm/s").symbol) == TEXTS[choice]
    assert ANGLE_MEASURE.text_of(0.1) == "5.7°"
    assert shown_unit("°") == shown_unit("°/s").__class__("°")


@pytest.mark.parametrize(("choice", "per_metre"), [("usual", 1.0), ("m", 1.0), ("cm", 100.0), ("in", 1 / 0.0254)])
def test_a_field_shows_and_takes_the_unit_and_tells_the_length(qtbot, lengths, choice, per_metre):
    lengths(choice)
    field, told = NumberField("Length", "m", 0.001, 10.0, 0.01, 3), []
    qtbot.addWidget(field)
    field.edited.connect(told.append)
    field.show_value(1.27)
    assert field.value() == pytest.approx(1.27 * per_metre)
    field.selectAll()
    QTest.keyClicks(field, f"{0.508 * per_metre:.3f}")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert told == [pytest.approx(0.508, abs=1e-6)]
    field.setValue(1e9)
    assert told[-1] == pytest.approx(10.0, abs=1e-4)
    field.set_unit("")
    field.show_value(0.5)
    assert (field.value(), field.suffix()) == (0.5, "")


def test_forms_are_in_inches_and_what_is_typed_there_is_as_long_in_the_document(qtbot, lengths):
    lengths("in")
    document = Document(make_project())
    inspector = Inspector(document, SolvedLive(document))
    qtbot.addWidget(inspector)
    inspector.show()
    document.selection.set(("constraints", "constraint 0"))
    document.replace(
        "constraints",
        "constraint 0",
        replace(document.project.constraints["constraint 0"], target=(0.254, 0.0, 1.0)),
        "",
    )
    field = named(inspector, NumberField, "Target X")
    assert field.value() == pytest.approx(10.0)
    offset = named(inspector, NumberField, "Offset X")
    for each in (field, offset):
        each.selectAll()
        QTest.keyClicks(each, "20")
        QTest.keyClick(each, Qt.Key.Key_Return)
    constraint = document.project.constraints["constraint 0"]
    assert constraint.target[0] == pytest.approx(0.508)
    assert constraint.point.offset[0] == pytest.approx(0.508)
    document.close()


def test_curves_of_places_have_the_unit_and_their_keys_the_length(lengths):
    lengths("cm")
    keyed = KeyedPlace((0.0, 1.0), ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)))
    channel = channels_of(KeyedField("constraints", "reach", "target"), keyed)[0]
    assert channel.unit == "cm"
    assert key_values(channel, keyed) == pytest.approx([10.0, 40.0])
    assert with_values(channel, keyed, {1: 70.0}).points[1] == pytest.approx((0.7, 0.5, 0.6))
