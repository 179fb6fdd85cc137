"""Local poses: rotations of the parts of a body that fit bodies of any build."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.stage.local_pose import LocalPose, local_pose, posed_rotations


@given(seed=st.integers(0, 2**32), spine_count=st.integers(3, 6))
def test_a_body_that_is_posed_has_that_pose(seed, spine_count):
    random = np.random.default_rng(seed)
    rotations = {part: tuple(random.uniform(-1.2, 1.2, 3)) for part in BodyPart}
    rotations[BodyPart.PELVIS] = (*rotations[BodyPart.PELVIS][:2], 0.0)
    layout = BodyLayout(spine_count)
    first = local_pose(layout, posed_rotations(layout, LocalPose(rotations, 1.0)), 1.0)
    again = local_pose(layout, posed_rotations(layout, first), 1.0)
    for part in BodyPart:
        assert again.rotations[part] == pytest.approx(first.rotations[part], abs=1e-7)
        if part is not BodyPart.PELVIS:
            assert first.rotations[part] == pytest.approx(rotations[part], abs=1e-7)


def test_a_body_of_two_vertebrae_bends_its_thorax_for_the_missing_abdomen():
    rotations = dict.fromkeys(BodyPart, (0.0, 0.0, 0.0))
    rotations |= {BodyPart.ABDOMEN: (0.0, 0.4, 0.0), BodyPart.THORAX: (0.0, 0.3, 0.0)}
    layout = BodyLayout(2)
    found = local_pose(layout, posed_rotations(layout, LocalPose(rotations, 1.0)), 1.0)
    assert found.rotations[BodyPart.THORAX] == pytest.approx((0.0, 0.7, 0.0))
