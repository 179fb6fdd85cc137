"""The activation of a new constraint: full where the limb is now, and as gentle as the speed of the limb needs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.constraints.fitted_activation import HOLD, RAMP, fitted_activation
from studio.core.curves.activation import ActivationCurve

SECONDS = np.arange(360) / 120.0
USUAL = (HOLD, RAMP)
NONE = 1e-9


def kick(middle: float = 1.5, width: float = 0.12, metres: float = 1.2) -> np.ndarray:
    """(F, 3) metres: out and back, fastest a moment before and after its end."""
    way = metres * np.exp(-(((SECONDS - middle) / width) ** 2))
    return np.column_stack([way, 0.2 * way, 0.5 * way])


def growth(curve: ActivationCurve, values: np.ndarray, now: float) -> float:
    """Peak speed of the limb drawn to where it is now, over that of the limb as it was: in 0.4 s around, or more."""
    there = np.array([np.interp(now, SECONDS, column) for column in values.T])
    drawn = values + curve.at(SECONDS)[:, None] * (there - values)
    first, last = np.searchsorted(SECONDS, [min(curve.start, now - 0.4), max(curve.end, now + 0.4)])
    return peak(drawn[first:last]) / peak(values[first:last])


def peak(values: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(values, axis=0), axis=1).max())


def sides(curve: ActivationCurve, now: float) -> tuple[float, ...]:
    return now - curve.full, curve.full - curve.start, curve.full_end - now, curve.end - curve.full_end


@given(st.floats(-0.3, 0.3), st.floats(0.1, 0.3), st.floats(0.3, 2.0))
def test_a_kick_that_is_held_anywhere_keeps_its_speed_within_a_tenth(late: float, width: float, metres: float) -> None:
    values, now = kick(width=width, metres=metres), round((1.5 + late) * 120) / 120
    curve = fitted_activation(SECONDS, values, now, 0.0, 3.0)
    assert curve.at(now) == 1.0
    assert 0.9 < growth(curve, values, now) < 1.1


def test_the_usual_activation_would_change_it_by_more() -> None:
    usual = ActivationCurve(1.1, 1.4, 1.6, 1.9)
    assert growth(usual, kick(width=0.2), 1.5) > 1.4
    assert growth(usual, kick(width=0.1), 1.5) < 0.8


def test_what_rests_has_the_usual_activation() -> None:
    curve = fitted_activation(SECONDS, np.zeros((360, 3)), 1.5, 0.0, 3.0)
    assert sides(curve, 1.5) == pytest.approx((*USUAL, *USUAL))


def test_what_passes_at_an_even_speed_is_let_catch_up() -> None:
    values = np.column_stack([1.4 * SECONDS, 0.0 * SECONDS, 0.0 * SECONDS])
    assert growth(fitted_activation(SECONDS, values, 1.5, 0.0, 3.0), values, 1.5) < 1.25
    assert growth(ActivationCurve(1.1, 1.4, 1.6, 1.9), values, 1.5) > 1.5


@given(st.floats(0.0, 3.0))
def test_it_stays_within_its_clip(now: float) -> None:
    curve = fitted_activation(SECONDS, kick(), now, 0.0, 2.99)
    assert -NONE <= curve.start <= curve.full <= now + NONE
    assert curve.end <= max(now, 2.99) + NONE
