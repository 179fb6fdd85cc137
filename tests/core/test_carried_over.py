"""What is asked of a motion, where a clip of it plays."""

from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import Carry, carried_over
from studio.core.constraints.position import PositionConstraint

seconds = st.floats(-5.0, 5.0)


@given(st.lists(seconds, min_size=4, max_size=4).map(sorted), seconds, seconds, st.floats(0.1, 4.0))
def test_what_is_asked_comes_and_goes_while_its_clip_plays_however_short_that_is(
    times: list[float], first: float, last: float, speed: float
) -> None:
    """Of a clip that others cover from its first frame on, the last comes before the first: nothing is asked then."""
    asked = PositionConstraint("m", "hold", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, ActivationCurve(*times))
    curve = carried_over(asked, Carry(0.0, speed, 0.0, (0.0, 0.0), False, first, last)).activation
    assert (curve.at([min(first, last) - 1e-6, max(first, last) + 1e-6]) == 0.0).all()
    assert first <= last or (curve.at([first, last]) == 0.0).all()
