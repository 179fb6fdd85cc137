"""New constraints, one verb for all kinds."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from studio.app.file_dialogs import ask_file
from studio.app.workbench import Workbench
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.errors import StudioError
from studio.document.priorities import shift_priorities
from studio.io.meshes.mesh_file import MESH_SUFFIXES, MeshFile, read_mesh
from studio.panels.message_strip import Lifetime

NO_JOINT = "Click a joint in the 3D view first, or press Shift+J to choose one: the constraint will hold it."


def constraint_adder(kind: str) -> Callable[[Workbench], None]:
    """Function that adds a constraint of ``kind`` at the joint picked in the viewport, or to the active body."""

    def add(bench: Workbench) -> None:
        if bench.viewport.add_constraint_at_pick(kind) is None:
            raise StudioError(NO_JOINT)

    return add


def choose_joint(bench: Workbench) -> None:
    """Let the user pick a joint of the active body from a searchable list."""
    from studio.viewport.body_points import body_joints  # late: a window opens before its views are loaded
    from studio.viewport.picking import PickedJoint

    viewport, document = bench.viewport, bench.document
    performer_id = document.active_performer_id or ""
    pose = viewport.posed.get(performer_id)
    if pose is None:
        raise StudioError("Show a character that has a clip first: its joints are listed then.")
    choices = [
        ((joint.name.capitalize(), pose.performer.name), partial(viewport.pick, PickedJoint(performer_id, joint)))
        for joint in body_joints(pose.motion.morphology.layout)
    ]
    bench.window.choose("Pick a joint", choices)


def pick_skin(bench: Workbench) -> None:
    """Let the next click in the 3D view pick a point on a skin."""
    bench.viewport.begin_skin_pick()


def load_area_mesh(bench: Workbench) -> None:
    """Ask for the file of a mesh as the shape of the selected area."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in MESH_SUFFIXES)})"
    ask_file(bench, "Load mesh for area", kinds, lambda path: put_area_mesh(bench, path))


def put_area_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then set it on the selected area; one undo step."""
    area_id = selected_area(bench)
    if area_id is None:
        raise StudioError("Select an area constraint first: the mesh becomes its shape.")

    def done(file: MeshFile) -> None:
        area = bench.document.project.constraints.get(area_id)
        if isinstance(area, AreaConstraint):
            new = replace(area, shape=AreaShape.MESH, mesh=file.mesh)
            bench.document.replace("constraints", area_id, new, f"Load {path.name} for {area.name}")
            bench.inform(f"{path.name}: {file.guesses}.", until=Lifetime.EDITED)

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def selected_area(bench: Workbench) -> str | None:
    """The selected constraint if it is an area."""
    constraints = bench.document.project.constraints
    selected = bench.document.selection.of("constraints")
    return next((key for key in selected if isinstance(constraints.get(key), AreaConstraint)), None)


def priority_shifter(step: int) -> Callable[[Workbench], None]:
    """Function that moves the selected constraints together up (-1) or down (1) in their motion's order."""

    def run(bench: Workbench) -> None:
        constraints = bench.document.project.constraints
        chosen = [key for key in bench.document.selection.of("constraints") if key in constraints]
        if not chosen:
            raise StudioError("Select a constraint first to change its priority.")
        if not shift_priorities(bench.document, chosen, step):
            subject = constraints[chosen[0]].name if len(chosen) == 1 else "The selection"
            bench.post_message(
                f"{subject} already has the {'highest' if step < 0 else 'lowest'} priority.", until=Lifetime.SELECTED
            )

    return run


def selected_constraint(bench: Workbench) -> str | None:
    """Constraint that was selected last."""
    chosen = bench.document.selection.of("constraints")
    return chosen[-1] if chosen and chosen[-1] in bench.document.project.constraints else None
