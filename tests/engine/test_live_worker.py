"""The worker that steps a live stage leaves the window its time: it makes what is seen."""

import time
from types import SimpleNamespace

import pytest

from studio.core.stage.project import Project
from studio.engine.live_play import STAGE_STEP_SECONDS, UNSEEN_STEP_SECONDS, _Worker
from tests.patience import SECONDS


class Stage:
    """Takes no time and counts its steps."""

    def __init__(self) -> None:
        self.project = self.staged = Project()
        self.seconds, self.running, self.failures, self.steps = 0.0, {}, {}, 0

    def step(self, dt: float) -> dict[str, SimpleNamespace]:
        self.steps += 1
        return {}


@pytest.mark.parametrize(("drawn", "apart"), [(False, UNSEEN_STEP_SECONDS), (True, STAGE_STEP_SECONDS)])
def test_a_step_waits_for_a_picture_of_the_last_one_but_not_for_long(drawn, apart):
    stage, broken = Stage(), []
    worker = _Worker(stage, lambda: None, broken.append)
    begun = time.monotonic()
    worker.start()
    while time.monotonic() < begun + (0.6 if stage.steps >= 3 else SECONDS):
        if drawn:
            worker.drawn.set()
        time.sleep(0.002)
    lasted, steps = time.monotonic() - begun, stage.steps
    worker.stop()
    assert not broken
    assert 3 <= steps <= lasted / apart + 2
