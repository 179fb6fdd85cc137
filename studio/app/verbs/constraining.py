"""Actions that add constraints and change their priorities."""

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

NO_JOINT_MESSAGE = "Click a joint in the 3D view first, or press Shift+J to choose one: the constraint will hold it."


def constraint_adder(kind: str) -> Callable[[Workbench], None]:
    """Function of the action that adds a constraint of ``kind`` at the joint picked in the 3D view, or to the active
    performer.
    """

    def add(bench: Workbench) -> None:
        if bench.viewport.add_constraint_at_pick(kind) is None:
            raise StudioError(NO_JOINT_MESSAGE)

    return add


def choose_joint(bench: Workbench) -> None:
    """Let the user pick a joint of the active performer from a searchable list."""
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
    """Let the next click in the 3D view pick a point on the skin."""
    bench.viewport.begin_skin_pick()


def load_area_mesh(bench: Workbench) -> None:
    """Ask for a mesh file as the shape of the selected volume constraint."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in MESH_SUFFIXES)})"
    ask_file(bench, "Load mesh for volume", kinds, lambda path: put_area_mesh(bench, path))


def put_area_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then make it the shape of the selected volume constraint; one undo step."""
    area_id = selected_area(bench)
    if area_id is None:
        raise StudioError("Select a volume constraint first: the mesh becomes its shape.")

    def done(file: MeshFile) -> None:
        area = bench.document.project.constraints.get(area_id)
        if isinstance(area, AreaConstraint):
            new = replace(area, shape=AreaShape.MESH, mesh=file.mesh)
            bench.document.replace("constraints", area_id, new, f"Load {path.name} for {area.name}")
            bench.inform(f"{path.name}: {file.guesses}.", until=Lifetime.EDITED)

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def selected_area(bench: Workbench) -> str | None:
    """Id of the first selected volume constraint; None if there is none."""
    constraints = bench.document.project.constraints
    selected = bench.document.selection.of("constraints")
    return next((key for key in selected if isinstance(constraints.get(key), AreaConstraint)), None)


def priority_shifter(step: int) -> Callable[[Workbench], None]:
    """Function of the action that moves the selected constraints up (``step`` -1) or down (1) in the priority order of
    their motion.
    """

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
    """Id of the constraint that was selected last; None if it is not a constraint."""
    chosen = bench.document.selection.of("constraints")
    return chosen[-1] if chosen and chosen[-1] in bench.document.project.constraints else None
