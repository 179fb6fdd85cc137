"""The one retreat: back along a step until what it disturbs is allowed."""

from collections.abc import Callable

import numpy as np
import pytest

from studio.core.kernels.search.backtracking import (
    BACKTRACKING,
    BACKTRACKING_STEPS,
    BACKTRACKING_TARGET,
    BACKTRACKING_TOLERANCE,
    next_step_length,
    start_backtracking,
    update_bracket,
)

ALLOWED = 8e-5


def _retreated(disturbs: Callable[[float], float], at_start: float = 0.0) -> tuple[float, float, int]:
    """Share and disturbance where a retreat ends, and how often it looked."""
    retreat, looks = np.zeros(1, BACKTRACKING)[0], 0
    start_backtracking(at_start, disturbs(1.0), ALLOWED, retreat)
    while next_step_length(retreat):
        update_bracket(disturbs(float(retreat["step_length"])), retreat)
        looks += 1
    return float(retreat["step_length"]), float(retreat["violation"]), looks


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 5.0])
@pytest.mark.parametrize("whole", [1e-4, 1e-3, 0.1, 10.0])
def test_it_ends_where_most_of_what_is_allowed_is_disturbed(power: float, whole: float) -> None:
    share, disturbs, looks = _retreated(lambda share: whole * share**power)
    assert disturbs == whole * share**power < ALLOWED
    assert looks <= BACKTRACKING_STEPS + 1
    if power >= 1.0 and whole <= 0.1:
        assert abs(disturbs - BACKTRACKING_TARGET * ALLOWED) < BACKTRACKING_TOLERANCE * ALLOWED


@pytest.mark.parametrize("edge", [0.05, 0.1, 0.5, 0.9])
def test_where_it_disturbs_all_at_once_it_stays_before_that(edge: float) -> None:
    share, disturbs, _ = _retreated(lambda share: 1.0 if share > edge else 0.0)
    assert disturbs == 0.0
    assert 0.4 * edge < share <= edge


def test_where_every_share_disturbs_it_ends_at_the_start_and_says_so() -> None:
    assert _retreated(lambda _: 1.0)[:2] == (0.0, 1.0)


def test_steps_that_differ_little_go_back_to_poses_that_differ_little() -> None:
    shares = [_retreated(lambda share, whole=whole: whole * share)[0] for whole in np.geomspace(1e-4, 0.1, 400)]
    wanted = BACKTRACKING_TARGET * ALLOWED / np.geomspace(1e-4, 0.1, 400)
    assert np.abs(np.divide(shares, wanted) - 1.0).max() < 1.5 * BACKTRACKING_TOLERANCE / BACKTRACKING_TARGET
