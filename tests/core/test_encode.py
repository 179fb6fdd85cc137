import numpy as np
import pytest

from studio.core.normalized.encode import encode_motion
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from tests.builders import make_capture, make_morphology


@pytest.mark.parametrize("body", [make_morphology(), make_morphology(0.7, 1.3, 4)], ids=["alike", "other"])
def test_a_posed_body_gives_the_motion_that_poses_it_so(body):
    motion, _ = normalize_capture(make_capture(frames=40, seed=3))
    positions, rotations = realize_motion(motion, body)
    again = realize_motion(encode_motion(positions, rotations, body, motion.frame_rate), body)
    assert np.abs(again[0] - positions).max() < 1e-6
    assert np.abs(again[1] - rotations).max() < 1e-6
