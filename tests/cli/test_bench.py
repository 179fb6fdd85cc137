"""`bench`: what is measured, and that it is what it is called. How fast it is, is not tested."""

import json
from dataclasses import replace

import numpy as np
import pytest

from studio.cli.bench import bundled_capture
from studio.cli.bench_cases import (
    BEYOND_REACH_METRES,
    ELBOW_OFFSET_METRES,
    LIMB_CHAIN,
    MOST_BENCH_FRAMES,
    clip_of,
    make_tasks,
)
from studio.cli.bench_timing import BenchJob, time_jobs
from studio.cli.main import main
from studio.core.solver.adapt import adapt
from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import chosen_characters, ready_capture


@pytest.fixture(scope="module")
def tasks():
    motion, contacts = clip_of(ready_capture(bundled_capture(), GUESS_ALL))
    return make_tasks(motion, contacts, chosen_characters(["adult_woman"])["adult_woman"].morphology)


def _named(tasks, word):
    return next(task for task in tasks if word in task.name)


def test_every_job_has_a_time_and_where_there_is_an_aim_a_ratio(capsys):
    assert main(["bench", "--json", "--runs", "1"]) == 0
    records = json.loads(capsys.readouterr().out)
    assert len(records) >= 10
    for record in records:
        assert record.keys() == {"name", "microseconds", "best", "paper", "aim", "ratio"}
        assert 0 < record["best"] <= record["microseconds"]
        if record["aim"] is None:
            assert record["ratio"] is None
        else:
            assert record["ratio"] == pytest.approx(record["microseconds"] / record["aim"])


def test_clips_begin_where_the_motion_does_and_end_in_time():
    ready = ready_capture(bundled_capture(), GUESS_ALL)
    motion, contacts = clip_of(ready, 100)
    assert motion.frame_count == 100
    first = ready.capture.first_frame
    assert np.array_equal(motion.channels, ready.motion.channels[first : first + 100])
    assert contacts
    assert max(each.last for each in contacts) < 100 < MOST_BENCH_FRAMES


def test_the_wrist_that_is_called_reachable_is_reached(tasks):
    for word in ("one reachable", "the same"):
        assert adapt(_named(tasks, word).request).residuals.max() < 2e-4


def test_the_wrist_that_is_called_ten_centimetres_beyond_is_missed_by_so_much_by_the_arm_alone(tasks):
    task = _named(tasks, "10 cm")
    balance, wrist = task.request.constraints
    alone = adapt(replace(task.request, constraints=(replace(wrist, chain=LIMB_CHAIN, priority=0),))).residuals[0]
    assert np.allclose(alone, BEYOND_REACH_METRES, atol=2e-3)
    assert balance.priority < wrist.priority


def test_the_elbow_that_is_called_lower_is_missed_and_takes_nothing_from_its_wrist(tasks):
    request = _named(tasks, "before elbow").request
    wrist, elbow = request.constraints
    both, alone = adapt(request).residuals, adapt(replace(request, constraints=(wrist,))).residuals
    assert elbow.priority > wrist.priority
    assert both[1].min() > ELBOW_OFFSET_METRES / 2
    assert (both[0] <= alone[0] + 2e-4).all()


def test_what_is_called_worst_is_out_of_reach_all_the_time(tasks):
    request = _named(tasks, "worst").request
    assert adapt(request).residuals[1:].min() > 0.05


def test_jobs_are_timed_for_one_of_what_they_do_and_the_best_is_no_longer_than_the_median():
    calls = []
    [timing] = time_jobs([BenchJob("count", lambda: calls.append(sum(range(20_000))), 10)], 3)
    assert len(calls) > 3
    assert 0.0 < timing.best <= timing.median


@pytest.mark.parametrize(("arguments", "sentence"), [(["none.bvh"], "none.bvh")])
def test_what_cannot_be_measured_is_a_sentence(capsys, arguments, sentence):
    assert main(["bench", *arguments]) == 1
    assert sentence in capsys.readouterr().err
