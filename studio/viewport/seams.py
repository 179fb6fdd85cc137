"""Seams of a plain skin: dark lines between panels, which make rotations of segments visible."""

from functools import lru_cache

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.mesh.skin import SkinnedMesh

PANEL_FIELD = "panel"
SHADE_COUNT = 512
"""Number of shades from the middle of one panel to that of the next."""
SEAM_HALF_WIDTH = 0.045
"""Half of the width of a seam in units of the panel field (-1 to 1): about three millimetres on an adult."""
PANEL_BRIGHTNESS = 1.0, 0.93
"""Brightness of panels with a positive and a negative sign, relative to the character's colour."""
SEAM_BRIGHTNESS = 0.42
"""Brightness of the seams relative to the character's colour."""
JOINED_PANELS = BodyPart.LEFT_TOE, BodyPart.RIGHT_TOE, BodyPart.LEFT_CLAVICLE, BodyPart.RIGHT_CLAVICLE, BodyPart.NECK
"""Segments that share the panel of their parent."""


def panel_field(skin: SkinnedMesh, layout: BodyLayout) -> NDArray[np.float32]:
    """(V,) signed panel field from -1 to 1; zero on seams, where a vertex has equal weights of two panels."""
    signs = panel_signs(layout)
    return np.asarray((signs[skin.segments] * skin.weights).sum(axis=1), dtype=np.float32)


@lru_cache
def panel_signs(layout: BodyLayout) -> NDArray[np.float32]:
    """(S,) sign, 1 or -1, of each segment's panel, opposite to that of its parent. The waist between pelvis and thorax
    is one panel.
    """
    signs = np.ones(layout.segment_count, dtype=np.float32)
    whole = {layout.segment_of_part(part) for part in JOINED_PANELS}
    for segment, parent in enumerate(layout.parent_segments()):
        if 0 < segment < layout.spine_count:
            signs[segment] = 1.0 if segment == layout.spine_count - 1 else -1.0
        elif parent >= 0:
            signs[segment] = signs[parent] if segment in whole else -signs[parent]
    return signs


def draw_seams(actor: pv.Actor, colour: str) -> None:
    """Colour an actor by its scalars in [-1, 1]: panels in shades of ``colour``, with seams between them."""
    actor.mapper.lookup_table = _table(colour)
    actor.mapper.scalar_range = (-1.0, 1.0)
    actor.mapper.interpolate_before_map = True
    actor.mapper.scalar_visibility = True


@lru_cache(maxsize=64)
def _table(colour: str) -> pv.LookupTable:
    values = np.linspace(-1.0, 1.0, SHADE_COUNT)
    line = np.clip(1.5 - np.abs(values) / SEAM_HALF_WIDTH, 0.0, 1.0)
    bright = np.where(values > 0.0, *PANEL_BRIGHTNESS) * (1.0 - line) + SEAM_BRIGHTNESS * line
    rgb = np.round(bright[:, None] * pv.Color(colour).int_rgb)
    table = pv.LookupTable(values=np.column_stack([rgb, np.full(SHADE_COUNT, 255)]).astype(np.uint8))
    table.scalar_range = (-1.0, 1.0)
    return table
