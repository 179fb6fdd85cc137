"""Moving parts of a posed body."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout
from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix
from studio.core.kernels.body import parts as kernel
from studio.core.normalized.realize import realize_motion
from tests.builders import make_morphology
from tests.core.motions import random_rotations, walk
from tests.core.twins import body as twin

seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
POSITIONS, ROTATIONS = (array[17] for array in realize_motion(walk(20)[0], BODY))


@given(seeds, st.integers(0, BodyLayout(4).segment_count - 1))
def test_turning_a_part_carries_all_that_hangs_on_it_and_keeps_every_bone(seed: int, segment: int) -> None:
    turn, positions, rotations = random_rotations(np.random.default_rng(seed)), POSITIONS.copy(), ROTATIONS.copy()
    pivot = POSITIONS[BODY.layout.proximal_points()[segment]].copy()
    kernel.rotate_part(rotation_from_matrix(turn), segment, BODY.layout.spine_count, pivot, positions, rotations)
    moved, turned = twin.turn_part(BODY.layout, turn, segment, POSITIONS, ROTATIONS)
    assert np.allclose(positions, moved, atol=1e-12)
    assert np.allclose(rotations, turned, atol=1e-12)
    lengths = [twin.bone_lengths(BODY.layout, each) for each in (POSITIONS, positions)]
    assert np.allclose(*lengths, atol=1e-12)


@given(seeds)
def test_the_whole_body_moves_together(seed: int) -> None:
    shift, positions = np.random.default_rng(seed).normal(size=3), POSITIONS.copy()
    kernel.translate_points(*shift, positions)
    assert np.allclose(positions, POSITIONS + shift, atol=1e-15)


@given(seeds)
def test_a_point_goes_with_its_segment(seed: int) -> None:
    random = np.random.default_rng(seed)
    offset, segment = random.normal(size=3), int(random.integers(BODY.layout.segment_count))
    point = int(random.integers(BODY.layout.point_count))
    found = kernel.body_point_position(point, segment, offset, POSITIONS, ROTATIONS)
    assert np.allclose(found, POSITIONS[point] + ROTATIONS[segment] @ offset, atol=1e-14)
