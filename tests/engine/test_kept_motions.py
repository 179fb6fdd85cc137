"""Solved motions as the window keeps them: as exact as anybody could see, in half the memory."""

import tracemalloc

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.constraints.base import Constraint
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.engine.standing_solver import GroundingSolver
from studio.io.project.character_file import bundled_characters
from tests.builders import make_constraint
from tests.core.motions import walk

MOTION, CONTACTS = walk(400)
BODY = bundled_characters()["child"].morphology
NEAR, ALIKE = 1e-5, np.radians(0.0005)
"""Metres and radians by which a file that is exported may differ: files are written of what is solved anew."""
MOST = 2850
"""Bytes a frame of a body and all that is asked of it again with every move of a hand."""


def asked() -> tuple[Constraint, ...]:
    return (make_constraint(),)


def test_what_is_kept_is_what_is_solved_to_a_hundredth_of_a_millimetre() -> None:
    request = AdaptRequest(MOTION, BODY, CONTACTS, asked())
    kept, solved = GroundingSolver()(request, 0, None), adapt(request)
    assert np.abs(kept.positions[:] - solved.positions[:]).max() < NEAR
    assert angle_between(from_matrix(kept.rotations[:]), from_matrix(solved.rotations[:])).max() < ALIKE


def test_a_body_of_which_something_is_asked_takes_less_than_three_kilobytes_a_frame() -> None:
    solver, request = GroundingSolver(), AdaptRequest(MOTION, BODY, CONTACTS, asked())
    solver(request, 0, None)  # what is made once for all bodies
    tracemalloc.start()
    kept = [solver(AdaptRequest(MOTION, body, CONTACTS, asked()), 0, None) for body in others()]
    taken = tracemalloc.get_traced_memory()[0] / len(kept) / MOTION.frame_count
    tracemalloc.stop()
    assert taken < MOST


def others() -> list[Morphology]:
    return [each.morphology for each in bundled_characters().values() if each.morphology is not BODY]
