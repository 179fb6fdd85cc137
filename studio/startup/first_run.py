"""One small pass through all that a moved slider or target will call, and its parts in the order they are needed."""

from studio.core.body.character import Character
from studio.core.mesh.skin import Blending
from studio.core.normalized.normalize import normalize
from studio.core.normalized.round_trip import round_trip
from studio.core.solver.warm_up import (
    warm_up,
    warm_up_constraints,
    warm_up_easing,
    warm_up_seldom,
    warm_up_standing,
    warm_up_support,
)
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.library.warm_up import warm_up as warm_up_search
from studio.resources_folder import example_captures_folder
from studio.startup import first_picture


def run() -> None:
    """Adapt a few frames to the first bundled character and skin it: what every scene calls."""
    warm_up(_character().morphology)
    first_picture.run()


def run_seldom() -> None:
    """What is not called by every scene: a library is searched, and what few ask of the solver."""
    warm_up_seldom(_character().morphology)
    first_picture.run(Blending.DUAL_QUATERNIONS)
    warm_up_search()
    _read()


def run_standing() -> None:
    """What comes before any constraint: a capture is read and normalised, and stands on the ground of any body."""
    warm_up_standing(_character().morphology)
    _read()
    warm_up_support(_character().morphology)


def run_rest() -> None:
    """What ``run_standing`` and ``run_constraints`` leave: what eases jolts, then what is seldom called."""
    warm_up_easing(_character().morphology)
    run_seldom()


def run_constraints() -> None:
    """The part of ``run`` that takes longest to compile, by itself."""
    warm_up_constraints(_character().morphology)


def _read() -> None:
    for path in example_captures_folder().glob("front_kick.bvh"):
        capture = load_capture(path)
        round_trip(capture, *normalize(capture))


def _character() -> Character:
    return next(iter(bundled_characters().values()))
