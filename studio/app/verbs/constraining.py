"""New constraints, one verb for all kinds, and props for them to follow."""

import math
from collections.abc import Callable

import numpy as np

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.core.project import Prop

AHEAD = 0.6
"""Metres from a body's root to a new box."""


def adder(kind: str) -> Callable[[Workbench], None]:
    """A verb that adds a constraint of ``kind`` at the joint picked in the viewport, or to the active body."""

    def add(bench: Workbench) -> None:
        if bench.viewport.add_constraint_at_pick(kind) is None:
            raise StudioError("Click a joint in the viewport first: that is what the constraint will be about.")

    return add


def add_box(bench: Workbench) -> None:
    """A box on the ground ahead of the active body, or in the middle of the stage."""
    document = bench.document
    size = Prop("").size
    pose = bench.viewport.posed.get(document.active_performer_id or "")
    x, y, heading = 0.0, 0.0, 0.0
    if pose is not None:
        ahead = pose.placement.rotation @ pose.motion.rotations[pose.row, 0, :, 0]
        heading = math.atan2(ahead[1], ahead[0])
        x, y = (pose.points[0, :2] + AHEAD * np.array([math.cos(heading), math.sin(heading)])).tolist()
    floor = float(document.project.ground.height_at((x, y, 0.0)))
    taken = {prop.name for prop in document.project.props.values()}
    name = next(name for k in range(len(taken) + 1) if (name := f"Box {k + 1}" if k else "Box") not in taken)
    prop = Prop(name, size, (x, y, floor + size[2] / 2), heading)
    document.selection.set(("props", document.add("props", prop, f"Add {name}")))
