"""Six constraints on six levels, as users make them, are strict: acting wholly, in their ramps, and eased."""

from functools import cache

import pytest

from benchmarks.clips import BUNDLED
from benchmarks.scenes import COUNTS, LONGEST, Result, measure
from studio.cli.bench_cases import clip_of
from studio.core.grounds.ground import Ground
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.io.importing import GUESS_ALL
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ready_capture
from studio.resources_folder import example_captures_folder

LAW = 0.2
"""Millimetres."""
SEEDS = 4


@cache
def measured(clip: str, seed: int, exact: bool) -> list[Result]:
    """Results of a scene; of equal seeds, each clip is played by another body."""
    motion, contacts = clip_of(ready_capture(example_captures_folder() / clip, GUESS_ALL), LONGEST)
    bodies = list(bundled_characters().values())
    body = bodies[(BUNDLED.index(clip) + seed) % len(bodies)].morphology
    return measure(clip, ground_motion(motion, body, contacts, Ground()), seed, 1.0, exact, tries=1)


@pytest.mark.parametrize("clip", BUNDLED)
@pytest.mark.parametrize("exact", [False, True])
def test_what_is_asked_below_changes_nothing_that_is_missed_above(clip: str, exact: bool) -> None:
    for seed in range(SEEDS):
        results = measured(clip, seed, exact)
        assert [each.count for each in results] == list(COUNTS)
        assert max(each.changed for each in results) < LAW, seed
        assert max(each.ramped for each in results) < LAW, seed


@pytest.mark.parametrize("clip", BUNDLED)
def test_smoothing_makes_no_peak_greater(clip: str) -> None:
    for seed in range(SEEDS):
        for each in measured(clip, seed, False):
            assert each.peak < 1.1 * max(each.exact_peak, 3.0), each
