"""Constraints in a clip that is trimmed or split act smoothly, and only where there is time for them."""

from dataclasses import replace
from functools import cache
from itertools import count

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.performing import Performance, adapt_performers
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clip_halves
from studio.core.stage.project import Performer, Project
from studio.engine.residuals import residuals_on
from studio.jobs.performances import prepared_capture
from studio.library.scenes.stagehand import bodies, material

WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
REACH = PositionConstraint(
    "reach", "Reach", WRIST, Chain(trunk=0.5), 0, ActivationCurve(2.0, 2.4, 3.2, 3.6), target=(0.5, -0.2, 1.2)
)
WHOLE = Clip("reach", 30, 300, 0.0, "one")


@cache
def stuff():
    return material(reach=("Reach", "reach_grasp"))


def staged(*clips: Clip, **asked: PositionConstraint) -> Project:
    performers = {"one": Performer("One", "adult_woman", clips)}
    return Project(stuff().captures, stuff().motions, bodies(5), performers, asked, stuff().contacts)


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
    assert np.isfinite(missed.amounts[145:190]).all()
