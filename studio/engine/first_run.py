"""One small pass through all that a moved slider or target will call, and its halves for two processes."""

from studio.core.morphology import Morphology
from studio.core.skin import skin_vertices
from studio.core.solver.warm_up import warm_up, warm_up_constraints, warm_up_easing, warm_up_standing
from studio.io.character_file import bundled_characters


def run() -> None:
    """Adapt a few frames to the first bundled character and skin one of them."""
    character = next(iter(bundled_characters().values()))
    adapted = warm_up(character.morphology)
    skin_vertices(character.skin, character.build, character.morphology, adapted.positions[0], adapted.rotations[0])


def run_standing() -> None:
    """The part of ``run`` before the constraints, and what eases what they make jolt."""
    warm_up_standing(_body())
    warm_up_easing(_body())


def run_constraints() -> None:
    """The part of ``run`` that takes longest to compile, by itself."""
    warm_up_constraints(_body())


def _body() -> Morphology:
    return next(iter(bundled_characters().values())).morphology
