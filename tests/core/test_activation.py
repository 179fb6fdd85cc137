"""Activations: functions of time only, as gentle as a limb needs, and smooth where a clip is trimmed or split."""

from dataclasses import replace
from functools import cache
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.fitted_activation import DEFAULT_HOLD_SECONDS, DEFAULT_RAMP_SECONDS, fitted_activation
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve, EaseShape, ease
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import Performance, adapt_performers
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clip_halves
from studio.core.stage.project import Performer, Project
from studio.engine.residuals import residuals_on
from studio.jobs.performances import prepared_capture
from studio.library.scenes.stagehand import source_motions, varied_characters

# An activation curve is a function of time only.


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


def test_an_unknown_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="bouncy"):
        ActivationCurve(0.0, 1.0, 2.0, 3.0, "bouncy")  # type: ignore[arg-type]


# The activation of a new constraint: full where the limb is now, and as gentle as the speed of the limb needs.


SECONDS = np.arange(360) / 120.0
USUAL = (DEFAULT_HOLD_SECONDS, DEFAULT_RAMP_SECONDS)
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


@given(st.floats(0.15, 0.3), st.floats(0.3, 2.0))
def test_a_kick_soon_after_its_stance_keeps_its_speed_though_the_contact_releases_it_slowly(
    since: float, metres: float
) -> None:
    values, now = kick(metres=metres), 1.45
    freedom = np.clip((SECONDS - (now - since)) / 0.15, 0.0, 1.0) ** 2
    curve = fitted_activation(SECONDS, values, now, now - since, 3.0, freedom=freedom)
    here = np.array([np.interp(now, SECONDS, column) for column in values.T])
    drawn = values + (freedom * curve.at(SECONDS))[:, None] * (here - values)
    before = now >= SECONDS
    assert peak(drawn[before]) < 1.1 * peak(values[before])


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


# Constraints in a clip that is trimmed or split act smoothly, and only where there is time for them.


WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
REACH = PositionConstraint(
    "reach", "Reach", WRIST, Chain(trunk=0.5), 0, ActivationCurve(2.0, 2.4, 3.2, 3.6), target=(0.5, -0.2, 1.2)
)
WHOLE = Clip("reach", 30, 300, 0.0, "one")


@cache
def stuff():
    return source_motions(reach=("Reach", "reach_grasp"))


def staged(*clips: Clip, **asked: PositionConstraint) -> Project:
    performers = {"one": Performer("One", "adult_woman", clips)}
    return Project(stuff().captures, stuff().motions, varied_characters(5), performers, asked, stuff().contacts)


def played(*clips: Clip, **asked: PositionConstraint) -> Performance:
    return adapt_performers(staged(*clips, **asked), ["one"], prepared_capture, adapt).performances["one"]


@pytest.mark.parametrize("second", [1.6, 1.7, 2.2, 2.9])
@pytest.mark.parametrize("narrow", [False, True])
def test_a_split_clip_does_what_it_is_asked_as_it_did(second: float, narrow: bool) -> None:
    """At the split the hand left its place, came back, and the body with it."""
    parts = clip_halves(WHOLE, 60.0, second, (f"part {number}" for number in count()))
    asked = {each.id: replace(REACH, scope=Scope(clip_id=each.id)) for each in parts} if narrow else {"reach": REACH}
    whole, cut = played(WHOLE, reach=REACH).adapted_on_stage, played(*parts, **asked).adapted_on_stage
    np.testing.assert_allclose(
        cut.positions[30:], whole.positions[30:], atol=1e-3
    )  # who begins stands as what was before lets it


@pytest.mark.parametrize("last", [100, 121, 130, 140])
def test_what_a_clip_leaves_no_time_for_is_not_asked(last: int) -> None:
    """For one frame the hand was at the place that the clip never came to."""
    short = replace(WHOLE, last=last)
    after = Clip("reach", 300, 400, (last - 29) / 60.0, "after")
    np.testing.assert_array_equal(
        played(short, after, reach=REACH).adapted.positions, played(short, after).adapted.positions
    )


def test_what_a_clip_ends_in_the_middle_of_goes_before_it_ends() -> None:
    short, after = replace(WHOLE, last=180), Clip("reach", 300, 400, 151 / 60.0, "after")
    asked, unasked = (played(short, after, **each).adapted.positions for each in ({"reach": REACH}, {}))
    off = np.abs(asked - unasked).max(axis=(1, 2))
    assert off[130] > 0.02
    assert off[151:].max() < 2e-3  # an arm that came out of the body for it settles by degrees


def test_what_is_missed_in_both_parts_of_a_split_clip_is_told_of_both() -> None:
    parts = clip_halves(WHOLE, 60.0, 2.2, (f"part {number}" for number in count()))
    missed = residuals_on(staged(*parts, reach=REACH), "one", played(*parts, reach=REACH).adapted, "reach")
    assert missed is not None
    assert np.isfinite(missed.amounts[(missed.frames >= 145) & (missed.frames < 190)]).all()
