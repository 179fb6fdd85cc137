"""An activation curve is a function of time only."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.curves.activation import ActivationCurve, EaseShape, ease

times = st.floats(-100.0, 100.0)
shapes = st.sampled_from(EaseShape)


@st.composite
def curves(draw: st.DrawFn) -> ActivationCurve:
    """Any curve, ramps without length among them."""
    start = draw(times)
    gaps = [draw(st.sampled_from([0.0, 0.2]) | st.floats(1e-6, 10.0)) for _ in range(3)]
    return ActivationCurve(*np.cumsum([start, *gaps]).tolist(), draw(shapes))


@given(curves(), times)
def test_it_lies_between_0_and_1(curve: ActivationCurve, time: float) -> None:
    assert 0.0 <= curve.at(time) <= 1.0


@given(curves(), st.floats(0, 1))
def test_it_is_1_on_the_plateau(curve: ActivationCurve, share: float) -> None:
    time = np.clip(curve.full + share * (curve.full_end - curve.full), curve.full, curve.full_end)
    assert curve.at(time) == 1.0
    assert curve.is_whole(curve.full, time)
    assert curve.is_whole(time, curve.full_end)


@given(curves(), st.floats(1e-6, 10))
def test_it_is_0_outside(curve: ActivationCurve, seconds: float) -> None:
    assert curve.at(curve.start - seconds) == 0.0
    assert curve.at(curve.end + seconds) == 0.0
    assert not curve.is_whole(curve.start - seconds, curve.full_end)
    assert not curve.is_whole(curve.full, curve.end + seconds)


@given(curves())
def test_it_only_rises_before_the_plateau_and_only_falls_after(curve: ActivationCurve) -> None:
    assert (np.diff(curve.at(np.linspace(curve.start, curve.full, 50))) >= -1e-12).all()
    assert (np.diff(curve.at(np.linspace(curve.full_end, curve.end, 50))) <= 1e-12).all()


@given(curves(), times)
def test_time_reversed_mirrors_it(curve: ActivationCurve, time: float) -> None:
    reversed_curve = ActivationCurve(-curve.end, -curve.full_end, -curve.full, -curve.start, curve.shape)
    assert reversed_curve.at(-time) == curve.at(time)


@given(curves(), st.floats(-10, 10), times)
def test_moved_it_is_the_same_later(curve: ActivationCurve, seconds: float, time: float) -> None:
    ramps = np.diff([curve.start, curve.full, curve.full_end, curve.end])[[0, 2]]
    if (ramps == 0.0).any():
        return
    steepest = 2.0 / ramps.min()
    assert curve.moved(seconds).at(time + seconds) == pytest.approx(float(curve.at(time)), abs=1e-6 + 1e-12 * steepest)


@pytest.mark.parametrize(("shape", "order"), [("linear", 0), ("smooth", 1), ("quintic", 2)])
def test_it_joins_smoothly_to_the_order_of_its_shape(shape: str, order: int) -> None:
    """Derivatives up to ``order`` differ little on both sides of every corner, the next one does not."""
    curve, step = ActivationCurve(0.0, 1.0, 2.0, 3.0, EaseShape(shape)), 1e-3
    for corner in (0.0, 1.0, 2.0, 3.0):
        jumps = []
        for derivative in range(order + 2):
            samples = [curve.at(corner + step * np.arange(n, n + 1 + derivative)) for n in (-derivative - 1, 1)]
            before, after = (np.diff(each, derivative)[0] / step**derivative for each in samples)
            jumps.append(abs(after - before))
        assert max(jumps[: order + 1]) < 0.2
        assert jumps[order + 1] > 0.9


@given(curves(), st.lists(times, min_size=1, max_size=5))
def test_many_times_at_once_are_each_as_alone(curve: ActivationCurve, many: list[float]) -> None:
    assert curve.at(many).tolist() == [float(curve.at(time)) for time in many]


def test_a_ramp_without_length_is_a_step() -> None:
    assert ActivationCurve(1.0, 1.0, 2.0, 2.0).at([0.999, 1.0, 2.0, 2.001]).tolist() == [0.0, 1.0, 1.0, 0.0]


@given(shapes)
def test_every_ease_is_half_way_at_half_time_and_symmetric(shape: EaseShape) -> None:
    progress = np.linspace(-0.5, 1.5, 41)
    assert ease(0.5, shape) == 0.5
    assert np.allclose(ease(progress, shape) + ease(1.0 - progress, shape), 1.0)


@pytest.mark.parametrize("wrong", [(1.0, 0.5, 2.0, 3.0), (0.0, 1.0, 0.5, 3.0), (0.0, 1.0, 2.0, 1.9)])
def test_times_out_of_order_are_refused(wrong: tuple[float, float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"in order, start, full, full end, end: .* s are not"):
        ActivationCurve(*wrong)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_times_that_are_no_numbers_are_refused(wrong: float) -> None:
    with pytest.raises(ValueError, match="four finite times"):
        ActivationCurve(0.0, 1.0, 2.0, wrong)


def test_an_unknown_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="bouncy"):
        ActivationCurve(0.0, 1.0, 2.0, 3.0, "bouncy")  # type: ignore[arg-type]
