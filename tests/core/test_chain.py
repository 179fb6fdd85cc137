"""Point, chain and priority, which every constraint has."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, finite_vector
from studio.core.constraints.position import PositionConstraint
from tests.builders import make_constraint

PARTS = [field.name for field in fields(Chain) if field.default != ()]


def test_an_arm_alone_reaches_with_limb_and_clavicle() -> None:
    assert Chain() == Chain(limb=1.0, end_segment=0.0, clavicle=1.0, trunk=0.0, root=0.0)


@pytest.mark.parametrize("part", PARTS)
@given(weight=st.floats(max_value=-1e-9) | st.floats(min_value=1.000001) | st.just(np.nan))
def test_a_weight_beyond_0_and_1_is_refused_by_name(part: str, weight: float) -> None:
    with pytest.raises(ValueError, match=f"lies between 0 and 1: {part} is"):
        Chain(**{part: weight})


@pytest.mark.parametrize("part", PARTS)
@given(weight=st.floats(1e-6, 1.0))
def test_one_free_part_makes_a_chain(part: str, weight: float) -> None:
    locked = dict.fromkeys(PARTS, 0.0)
    assert getattr(Chain(**locked | {part: weight}), part) == weight


def test_a_chain_that_is_locked_throughout_is_refused() -> None:
    with pytest.raises(ValueError, match="without any free part"):
        Chain(0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("wrong", [(0.0, 0.0), (0.0, np.nan, 0.0), (np.inf, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)])
def test_points_and_targets_are_three_finite_numbers(wrong: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="A point's offset is three finite numbers"):
        BodyPoint(BodyPart.HEAD, wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'Wrist': a target is three finite numbers"):
        make_constraint(name="Wrist", target=wrong)


def test_vectors_are_taken_from_arrays_and_kept_as_plain_numbers() -> None:
    assert finite_vector(np.array([1, 2, 3]), "It") == (1.0, 2.0, 3.0)
    assert make_constraint(target=np.zeros(3)) == make_constraint(target=(0.0, 0.0, 0.0))


def test_a_priority_above_the_highest_is_refused() -> None:
    with pytest.raises(ValueError, match=r"'Right wrist': a priority is 0 \(highest\) or more, got -1"):
        make_constraint(priority=-1)


def test_a_part_may_be_called_by_its_name_and_no_other() -> None:
    assert BodyPoint("left_hand").part is BodyPart.LEFT_HAND  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="tail"):
        BodyPoint("tail")  # type: ignore[arg-type]


def test_constraints_are_values() -> None:
    constraint = make_constraint()
    assert constraint == make_constraint()
    assert len({constraint, make_constraint(), replace(constraint, priority=3)}) == 2
    assert PositionConstraint.kind == "position"


@pytest.mark.parametrize("number", [1e16, 1e160, np.inf, np.nan])
def test_a_place_that_is_nowhere_is_refused(number: float) -> None:
    with pytest.raises(ValueError, match=r"A place (is three finite numbers in metres|of .* cannot be true)"):
        finite_vector((0.0, number, 0.0), "A place")
