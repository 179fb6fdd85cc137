"""Handles of grips act as long as their prop is held."""

import pytest

from studio.core.stage.placement import Placement
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.handles import constraint_handles
from tests.core.test_props import GIVEN, handing, looped, performed


@pytest.mark.parametrize(("time", "activation"), [(2.0, 1.0), (6.0, 0.0)])
def test_no_handle_of_a_grip_acts_as_the_clip_plays_again_after_the_prop_was_given(time, activation):
    """Red lines led from the hands of who had given a box away to it."""
    assert (time < GIVEN) is (activation == 1.0)
    project = looped(handing())
    made = performed(project).performances
    posed = {
        key: PosedPerformer(
            project.performers[key],
            each.adapted,
            round((time - each.composite.timing.begin) * 60.0),
            Placement.of(project.performers[key]),
        )
        for key, each in made.items()
    }
    one = next(iter(project.performers))
    handles = [each for each in constraint_handles(project, posed, one) if each.performer_id == one]
    assert [each.activation for each in handles] == [activation] * len(handles)
    assert handles
