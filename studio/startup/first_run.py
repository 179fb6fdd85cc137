"""Small test run of all code that a moved slider or target calls, and its parts in the order in which they
are needed.
"""

from studio.core.mesh.character import Character
from studio.core.mesh.skin import Blending
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.round_trip import round_trip
from studio.core.solver.warm_up import (
    warm_up,
    warm_up_constraints,
    warm_up_easing,
    warm_up_grounded_motion,
    warm_up_seldom,
    warm_up_support,
)
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.library.search_warm_up import warm_up as warm_up_search
from studio.resources_folder import example_captures_folder
from studio.startup import first_picture


def run() -> None:
    """Adapt a few frames to the first bundled character and skin it: the calls of every scene."""
    warm_up(_character().morphology)
    first_picture.run()


def run_seldom() -> None:
    """Run the code that few scenes need: rare solver kernels, dual-quaternion skinning, the library search, reading
    captures.
    """
    warm_up_seldom(_character().morphology)
    first_picture.run(Blending.DUAL_QUATERNIONS)
    warm_up_search()
    _read()


def run_standing() -> None:
    """Run the steps before constraints: reading and normalising a capture, and grounding any body."""
    warm_up_grounded_motion(_character().morphology)
    _read()
    warm_up_support(_character().morphology)


def run_rest() -> None:
    """Run the parts outside ``run_standing`` and ``run_constraints``: temporal smoothing, then ``run_seldom``."""
    warm_up_easing(_character().morphology)
    run_seldom()


def run_constraints() -> None:
    """Run the solver of constraints, whose kernels take longest to compile."""
    warm_up_constraints(_character().morphology)


def _read() -> None:
    for path in example_captures_folder().glob("front_kick.bvh"):
        capture = load_capture(path)
        round_trip(capture, *normalize_capture(capture))


def _character() -> Character:
    return next(iter(bundled_characters().values()))
