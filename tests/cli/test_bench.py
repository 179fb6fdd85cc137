"""`bench`: what is measured, and that it is what it is called. How fast it is, is not tested."""

import json
from pathlib import Path

import numpy as np
import pytest

from studio.cli.adaptation import chosen_characters, ready_capture
from studio.cli.bench import bundled_capture
from studio.cli.bench_cases import ARM, FRAMES, long_motion, wrist_target
from studio.cli.main import main
from studio.core.contacts import FootPoint
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.importing import GUESS_ALL


@pytest.fixture(scope="module")
def ready():
    return ready_capture(Path(bundled_capture()), GUESS_ALL)


def test_every_job_has_a_time_and_where_there_is_a_reference_a_ratio(capsys):
    assert main(["bench", "--json", "--runs", "1"]) == 0
    records = json.loads(capsys.readouterr().out)
    assert len(records) >= 8
    for record in records:
        assert record.keys() >= {"name", "microseconds", "reference", "ratio"}
        assert record["microseconds"] > 0
        if record["reference"] is None:
            assert record["ratio"] is None
        else:
            assert record["ratio"] == pytest.approx(record["microseconds"] / record["reference"])


def test_the_clip_that_is_measured_runs_on_without_a_jump(ready):
    motion, contacts = long_motion(ready)
    assert motion.frame_count == FRAMES
    assert max(each.last for each in contacts) < FRAMES
    assert {each.point for each in contacts} <= set(FootPoint)
    longest = np.abs(np.diff(ready.motion.channels, axis=0)).max()
    assert np.abs(np.diff(motion.channels, axis=0)).max() <= longest + 1e-12


def test_the_wrists_that_are_called_reachable_are_reached(ready):
    motion, contacts = long_motion(ready)
    body = chosen_characters(["adult_woman"])["adult_woman"].morphology
    feet = adapt(AdaptRequest(motion, body, contacts))
    targets = tuple(wrist_target(feet, side, 0.8, ARM) for side in (0, 1))
    solved = adapt(AdaptRequest(motion, body, contacts, targets))
    assert solved.residuals.max() < 2e-4


@pytest.mark.parametrize(("arguments", "sentence"), [(["--runs", "0"], "one run"), (["none.bvh"], "none.bvh")])
def test_what_cannot_be_measured_is_a_sentence(capsys, arguments, sentence):
    assert main(["bench", *arguments]) == 1
    assert sentence in capsys.readouterr().err
