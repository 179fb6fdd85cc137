"""One small pass through all that a moved slider or target will call."""

from studio.core.skin import skin_vertices
from studio.core.solver.warm_up import warm_up
from studio.io.character_file import bundled_characters


def run() -> None:
    """Adapt a few frames to the first bundled character and skin one of them."""
    character = next(iter(bundled_characters().values()))
    adapted = warm_up(character.morphology)
    skin_vertices(character.skin, character.build, character.morphology, adapted.positions[0], adapted.rotations[0])
