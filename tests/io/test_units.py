"""The unit of any file is found from its legs, a child's or a giant's; what a file says is believed where it may be."""

import math

import pytest

from studio.core.captures.confidence import Confidence
from studio.io.guessing import METRES_PER_UNIT, Scale, choose_unit, unit_of_metres


@pytest.mark.parametrize("leg", [0.72, 0.8, 0.9, 0.98])
@pytest.mark.parametrize("unit", METRES_PER_UNIT)
def test_the_leg_of_an_adult_tells_every_unit_that_programs_use(unit: str, leg: float) -> None:
    assert choose_unit(leg / METRES_PER_UNIT[unit])[0].unit == unit


@pytest.mark.parametrize(
    ("unit", "leg"), [("m", 0.3), ("cm", 0.45), ("mm", 0.3), ("dm", 0.5), ("m", 1.9), ("cm", 1.5), ("mm", 1.9)]
)
def test_children_and_giants_are_in_the_powers_of_ten(unit: str, leg: float) -> None:
    assert choose_unit(leg / METRES_PER_UNIT[unit])[0].unit == unit


@pytest.mark.parametrize("leg", [0.26, 0.5, 0.85, 1.4, 1.9])
def test_what_a_file_says_is_believed_where_it_makes_a_body(leg: float) -> None:
    assert choose_unit(leg, Scale("m", 1.0)) == (Scale("m", 1.0), None)


@pytest.mark.parametrize("unit", ["dm", "cm", "mm", "inch", "foot"])
def test_what_a_file_says_is_overruled_and_told_where_it_makes_none(unit: str) -> None:
    scale, guess = choose_unit(0.85 / METRES_PER_UNIT[unit], Scale("m", 1.0))
    assert scale.unit == unit
    assert guess is not None
    assert guess.reason.startswith("In m, as the file says, the legs would be")


@pytest.mark.parametrize("metres", [math.inf, math.nan, 0.0, -0.01, 1e-300, 1e300])
def test_a_unit_that_cannot_be_true_is_told_and_not_used(metres: float) -> None:
    """Also without a body that would show it."""
    for leg in (0.85, None):
        scale, guess = choose_unit(leg, unit_of_metres(metres))
        assert 0.005 < scale.metres <= 1.0
        assert guess is not None
        assert "file says" in guess.reason


def test_the_user_has_the_last_word() -> None:
    assert choose_unit(85.0, Scale("m", 1.0), "m") == (Scale("m", 1.0), None)
    assert choose_unit(2.8, None, "feet")[0].unit == "foot"


def test_a_unit_that_would_fit_as_well_is_told() -> None:
    _, guess = choose_unit(32.0)
    assert guess is not None
    assert guess.reason.startswith("The legs are 32 units long, in inch 0.81 m. In cm they would be 0.32 m: choose")
    assert guess.confidence is Confidence.LIKELY


@pytest.mark.parametrize("leg", [28.0, 31.0, 35.0, 39.0])
def test_toddlers_are_told_from_adults_in_inches_by_their_proportions(leg: float) -> None:
    """Legs of 28 to 39 units are a toddler's in centimetres or an adult's in inches: a toddler's trunk is as long."""
    assert choose_unit(leg, trunk=leg / 1.2)[0].unit == "cm"
    assert choose_unit(leg, trunk=leg / 1.7)[0].unit == "inch"


@pytest.mark.parametrize(("leg", "unit"), [(19.6, "dm"), (0.3, "m")])
def test_a_unit_that_makes_a_giant_or_a_dwarf_is_not_sure(leg: float, unit: str) -> None:
    """A child's leg in inches is a giant's in decimetres."""
    scale, guess = choose_unit(leg)
    assert guess is not None
    assert (scale.unit, guess.confidence) == (unit, Confidence.LIKELY)


def test_a_unit_is_as_sure_as_it_is_ahead_of_the_next() -> None:
    said = [choose_unit(leg, trunk=0.6 * leg)[1] for leg in (85.0, 0.85, 32.0, 3.0e-7)]
    assert [guess.confidence.value for guess in said if guess and guess.confidence] == [
        "sure",
        "sure",
        "likely",
        "doubtful",
    ]


def test_metres_a_unit_have_the_name_of_their_unit() -> None:
    assert [unit_of_metres(metres).unit for metres in (1.0, 0.01, 0.0254, 0.3048, 0.5)] == [
        "m",
        "cm",
        "inch",
        "foot",
        "0.5",
    ]
