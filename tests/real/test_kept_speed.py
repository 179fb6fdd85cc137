"""C at the fastest moment of a kick, as the engine solves it: the foot keeps its speed."""

import numpy as np
import pytest

from benchmarks.ground_depths import press, standing_on
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.viewport.body_points import body_joints
from tests.captures import capture_file, outside

KICKS = "accad_male2_G11_RoundhouseLeadingRight", "accad_male2_G6_AxeKick", "accad_male2_G5_BackKick", "cmu_135_06"
AROUND = 0.4
"""Seconds on either side of a press that are compared, if the activation is shorter."""


@pytest.mark.parametrize(("kick", "body"), outside(*((kick, body) for kick in KICKS for body in ("child", "giant"))))
def test_c_at_the_fastest_moment_of_a_kick_changes_the_peak_speed_of_the_foot_by_less_than_a_tenth(kick, body):
    standing = standing_on(f"strikes/{capture_file(f'bvh/strikes/{kick}.bvh').name}", body)
    before, rate = solve_constraints(standing, ()), standing.motion.frame_rate
    toes = [each for each in body_joints(standing.morphology.layout) if each.name in ("left toes", "right toes")]
    speeds = {each: _speeds(before, each, rate) for each in toes}
    joint = max(toes, key=lambda each: float(speeds[each].max()))
    row = int(speeds[joint].argmax())
    constraint = press(standing, joint, row)
    after = _speeds(solve_constraints(standing, (constraint,), eased=True), joint, rate)
    begin = max(int(min(constraint.activation.start, row / rate - AROUND) * rate), 0)
    end = int(max(constraint.activation.end, row / rate + AROUND) * rate) + 1
    assert after[begin:end].max() < 1.1 * speeds[joint][begin:end].max()


def _speeds(motion, joint, rate):
    return rate * np.linalg.norm(np.diff(body_point_positions(joint.point, motion), axis=0), axis=1)
