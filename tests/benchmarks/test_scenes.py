"""Six constraints on six levels, as users make them, are strict: acting wholly, in their ramps, and eased."""

import pytest

from benchmarks.clips import BUNDLED
from benchmarks.scenes import COUNTS, LONGEST, measure
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


@pytest.mark.parametrize("clip", BUNDLED)
@pytest.mark.parametrize("exact", [False, True])
def test_what_is_asked_below_changes_nothing_that_is_missed_above(clip: str, exact: bool) -> None:
    motion, contacts = clip_of(ready_capture(example_captures_folder() / clip, GUESS_ALL), LONGEST)
    for seed, body in enumerate(list(bundled_characters())[:SEEDS]):
        standing = ground_motion(motion, bundled_characters()[body].morphology, contacts, Ground())
        results = measure(f"{clip} {body}", standing, seed, 1.0, exact)
        assert [each.count for each in results] == list(COUNTS)
        assert max(each.changed for each in results) < LAW, seed
        assert max(each.ramped for each in results) < LAW, seed


@pytest.mark.parametrize(("place", "clip"), list(enumerate(BUNDLED)), ids=BUNDLED)
def test_smoothing_makes_no_peak_greater(place: int, clip: str) -> None:
    motion, contacts = clip_of(ready_capture(example_captures_folder() / clip, GUESS_ALL), LONGEST)
    bodies = list(bundled_characters().values())
    for seed in range(3):
        standing = ground_motion(motion, bodies[(place + seed) % len(bodies)].morphology, contacts, Ground())
        for each in measure(clip, standing, seed, 1.0):
            assert each.peak < 1.1 * max(each.exact_peak, 3.0), each
