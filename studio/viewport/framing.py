"""Points that the camera frames for the selection."""

from collections.abc import Iterable, Mapping

import numpy as np

from studio.document.document import Document
from studio.engine.posed_performer import PosedPerformer
from studio.engine.prop_places import PropPose
from studio.viewport.camera import FloatArray
from studio.viewport.handles import Handle

FRAMED_MARGIN_METRES = 0.6
"""Metres shown around a framed constraint or prop."""


def selected_points(
    document: Document, posed: Mapping[str, PosedPerformer], props: Mapping[str, PropPose], handles: Iterable[Handle]
) -> list[FloatArray]:
    """Stage points (N, 3) around the selected constraints and props; without any, of the selected performers."""
    around = FRAMED_MARGIN_METRES * np.concatenate([np.eye(3), -np.eye(3)])
    selection = document.selection
    chosen = [one for one in handles if one.is_primary and one.constraint_id in selection.of("constraints")]
    things = [one.extent for one in chosen]
    things += [props[key].place[None] for key in selection.of("props") if key in props]
    bodies = [posed[key].points for key in selection.of("performers") if key in posed]
    return [(thing[:, None] + around).reshape(-1, 3) for thing in things] or bodies
