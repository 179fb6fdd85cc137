"""Warm-up of the kernels that draw a body, apart from those of the solver, which take much longer."""

from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.skin import Blending, skin_vertices
from studio.io.project.character_file import bundled_characters


def run(blending: Blending = Blending.LINEAR) -> None:
    """Skin the first bundled character in its bind pose."""
    worn = next(iter(bundled_characters().values()))
    skin_vertices(worn.skin, worn.build, worn.morphology, *rest_pose(worn.morphology), blending=blending)
