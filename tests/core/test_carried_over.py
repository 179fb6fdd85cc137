"""Constraints of a motion, where a clip of it plays."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip, mirrored_constraint
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace
from studio.core.curves.activation import ActivationCurve

seconds = st.floats(-5.0, 5.0)


@given(st.lists(seconds, min_size=4, max_size=4).map(sorted), seconds, seconds, st.floats(0.1, 4.0))
def test_what_is_asked_comes_and_goes_while_its_clip_plays_however_short_that_is(
    times: list[float], first: float, last: float, speed: float
) -> None:
    """A clip that others cover from its first frame on ends before it begins: nothing is asked then."""
    asked = PositionConstraint("m", "hold", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, ActivationCurve(*times))
    curve = constraint_on_clip(asked, ClipTransform(0.0, speed, 0.0, (0.0, 0.0), False, first, last)).activation
    assert (curve.at([min(first, last) - 1e-6, max(first, last) + 1e-6]) == 0.0).all()
    assert first <= last or (curve.at([first, last]) == 0.0).all()


def test_keys_and_rules_per_character_are_mirrored_with_their_origin() -> None:
    point = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    own = OwnPlace(point, 0.5, (0.1, 0.2, 0.3), (("child", (0.0, 0.1, 0.0)),))
    mirrored = OwnPlace(
        BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), 0.5, (0.1, -0.2, 0.3), (("child", (0.0, -0.1, 0.0)),)
    )
    curve = ActivationCurve(0.0, 0.1, 1.0, 1.1)
    keyed = KeyedOwnPlace((0.2, 0.6), ((0.0, 0.0, 0.0), (0.1, 0.3, 0.2)), origin=own)
    asked = PositionConstraint("m", "reach", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, curve, target=keyed)
    seen = mirrored_constraint(asked)
    assert seen.target == KeyedOwnPlace((0.2, 0.6), ((0.0, 0.0, 0.0), (0.1, -0.3, 0.2)), origin=mirrored)  # type: ignore[attr-defined]
    assert mirrored_constraint(seen) == asked
    ruled = replace(asked, target=CirclePlace(centre=(0.0, 0.1, 0.2), origin=own))
    assert mirrored_constraint(ruled).target.origin == mirrored  # type: ignore[attr-defined]
    moved = constraint_on_clip(ruled, ClipTransform(0.0, 1.0, 0.0, (3.0, 4.0), False, 0.0, 2.0))
    assert moved.target.centre == (0.0, 0.1, 0.2)  # type: ignore[attr-defined]
