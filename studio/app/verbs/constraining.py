"""New constraints, one verb for all kinds, and props for them to follow."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.app.file_dialogs import ask_file
from studio.app.workbench import Workbench
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.project import Prop
from studio.io.mesh_file import SUFFIXES, MeshFile, read_mesh

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
    name = free_name("Box", {prop.name for prop in document.project.props.values()})
    prop = Prop(name, size, (x, y, floor + size[2] / 2), heading)
    document.selection.set(("props", document.add("props", prop, f"Add {name}")))


def load_area_mesh(bench: Workbench) -> None:
    """Ask for the file of a mesh, which becomes the shape of the selected area."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in SUFFIXES)})"
    ask_file(bench, "Load mesh for area", kinds, lambda path: put_area_mesh(bench, path))


def put_area_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then give it to the area that is selected now; one undo step."""
    area_id = selected_area(bench)
    if area_id is None:
        raise StudioError("Select an area constraint first: the mesh becomes its shape.")

    def done(file: MeshFile) -> None:
        area = bench.document.project.constraints.get(area_id)
        if isinstance(area, AreaConstraint):
            new = replace(area, shape=AreaShape.MESH, mesh=file.mesh)
            bench.document.replace("constraints", area_id, new, f"Load {path.name} for {area.name}")
            bench.said.emit(f"{path.name}: {file.guesses}.")

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def selected_area(bench: Workbench) -> str | None:
    """The selected constraint if it is an area."""
    constraints = bench.document.project.constraints
    selected = bench.document.selection.of("constraints")
    return next((key for key in selected if isinstance(constraints.get(key), AreaConstraint)), None)
