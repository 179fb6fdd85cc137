"""Plotted quantities of solved bodies: heights of feet, flexions, the centre of mass."""

import numpy as np
import pytest

from studio.timeline.curves import Quantity
from tests.gui.test_ten_tasks import staged, user

__all__ = ["user"]


@pytest.mark.parametrize("project", [staged("walk_turn", ("adult_woman",))])
def test_heights_angles_and_the_centre_of_mass_are_those_of_the_poses(user):
    [body] = user.solved().values()
    plot, values = user.timeline.tracks.picture.plot, {}
    for quantity in Quantity:
        user.timeline.tracks.set_quantity(quantity)
        user.timeline.tracks.grab()
        values[quantity] = plot.curves[0].values if plot.curves else None
    assert values[Quantity.ERROR] is None
    layout, height = body.morphology.layout, np.asarray(body.positions)[:, :, 2]
    for quantity, ankle in (
        (Quantity.LEFT_FOOT_HEIGHT, layout.ankle_point(0)),
        (Quantity.RIGHT_FOOT_HEIGHT, layout.ankle_point(1)),
    ):
        below = height[:, ankle] - values[quantity]
        assert ((below > 0.0) & (below < 0.3)).all()
        assert values[quantity].min() == pytest.approx(0.0, abs=0.005)
        assert values[quantity].max() > 0.02
    for quantity, first in (
        (Quantity.LEFT_KNEE_FLEXION, layout.hip_point(0)),
        (Quantity.RIGHT_KNEE_FLEXION, layout.hip_point(1)),
        (Quantity.LEFT_ELBOW_FLEXION, layout.collar_point(0) + 1),
        (Quantity.RIGHT_ELBOW_FLEXION, layout.collar_point(1) + 1),
    ):
        upper, lower = (body.positions[:, first + k + 1] - body.positions[:, first + k] for k in range(2))
        lengths = np.linalg.norm(upper, axis=1) * np.linalg.norm(lower, axis=1)
        assert np.cos(np.radians(values[quantity])) == pytest.approx((upper * lower).sum(axis=1) / lengths, abs=1e-6)
    mass = values[Quantity.COM_HEIGHT]
    assert ((mass > height[:, layout.hip_point(0) + 1]) & (mass < height[:, layout.neck_base])).all()
    assert 0.3 < values[Quantity.COM_SPEED].mean() < 2.0
