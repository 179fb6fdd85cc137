"""Props: new ones, of a shape or a mesh, and hands that hold them."""

import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from studio.app.file_dialogs import ask_file
from studio.app.workbench import Workbench
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.names import free_name
from studio.core.project import Performer, Project
from studio.core.stage.holding import REACHING, grips
from studio.core.stage.prop import Carried, InHand, Prop, PropShape
from studio.document.document import Document
from studio.engine.performance import motion_time, posed_performers
from studio.engine.props import between_hands
from studio.io.meshes.mesh_file import SUFFIXES, MeshFile, read_mesh

AHEAD = 0.6
"""Metres from a body's root to a new prop."""
SIZES = {
    PropShape.BOX: (0.4, 0.4, 0.4),
    PropShape.BALL: (0.22, 0.22, 0.22),
    PropShape.STICK: (0.03, 0.03, 1.2),
    PropShape.TABLE: (0.8, 1.2, 0.75),
    PropShape.STAIRS: (1.2, 1.0, 0.68),
}
"""Metres of a new prop, as things of its kind are."""


def add_box(bench: Workbench) -> None:
    """A box on the ground ahead of the active body, or in the middle of the stage."""
    add_shape(bench, PropShape.BOX)


def choose(bench: Workbench) -> None:
    """A prop of the shape that the user chooses."""
    shapes = [((shape.value.capitalize(), _words(shape)), partial(add_shape, bench, shape)) for shape in SIZES]
    bench.window.choose("Add a prop", [*shapes, (("Mesh file…", "OBJ, STL or PLY"), partial(ask_mesh, bench))])


def _words(shape: PropShape) -> str:
    return " × ".join(f"{side:g}" for side in SIZES[shape]) + " m"


def add_shape(bench: Workbench, shape: PropShape) -> None:
    """A prop of a shape, in a usual size."""
    _add(bench, Prop(shape.value.capitalize(), SIZES[shape], shape=shape))


def _add(bench: Workbench, prop: Prop) -> None:
    document = bench.document
    pose = bench.viewport.posed.get(document.active_performer_id or "")
    x, y, heading = 0.0, 0.0, 0.0
    if pose is not None:
        ahead = pose.placement.rotation @ pose.motion.rotations[pose.row, 0, :, 0]
        heading = math.atan2(ahead[1], ahead[0])
        away = AHEAD + max(prop.size[0] / 2 - 0.2, 0.0)
        x, y = (pose.points[0, :2] + away * np.array([math.cos(heading), math.sin(heading)])).tolist()
    floor = float(document.project.ground.height_at((x, y, 0.0)))
    name = free_name(prop.name, {each.name for each in document.project.props.values()})
    placed = replace(prop, name=name, position=(x, y, floor + prop.size[2] / 2), heading=heading)
    document.selection.set(("props", document.add("props", placed, f"Add {name}")))


def ask_mesh(bench: Workbench) -> None:
    """Ask for the file of a mesh, which becomes a prop."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in SUFFIXES)})"
    ask_file(bench, "Load mesh for a prop", kinds, lambda path: add_mesh(bench, path))


def add_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then put it on the stage in its own size; one undo step."""

    def done(file: MeshFile) -> None:
        _add(bench, Prop(path.stem, extent(file.mesh), shape=PropShape.MESH, mesh=file.mesh))
        bench.said.emit(f"{path.name}: {file.guesses}.")

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def extent(mesh: TriangleMesh) -> tuple[float, float, float]:
    """Metres of a mesh in each direction; a millimetre where it is flat."""
    x, y, z = np.maximum(mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0), 0.001).tolist()
    return x, y, z


def selected_prop(bench: Workbench) -> str | None:
    """The selected prop."""
    props = bench.document.project.props
    return next((key for key in bench.document.selection.of("props") if key in props), None)


def is_held(bench: Workbench) -> bool:
    """Whether somebody holds the selected prop at some time."""
    prop_id = selected_prop(bench)
    return prop_id is not None and bool(bench.document.project.props[prop_id].holds)


def hold(bench: Workbench) -> None:
    """The active body carries the selected prop, a hand on either side of it, in all that it plays."""
    _hold(bench, None)


def pick_up(bench: Workbench) -> None:
    """The active body picks the selected prop up at the playhead, with both hands unless it has it in one.

    Who holds it then lets go of it: it is handed over.
    """
    document, prop_id, performer_id = _holding(bench)
    prop, now = document.project.props[prop_id], document.playhead.time
    hold = prop.held_at(now) or prop.held
    if isinstance(hold, InHand) and hold.performer_id == performer_id:
        end = hold.end if hold.end is not None and hold.end > now else None
        held = prop.with_span(hold, now, end)
        document.replace("props", prop_id, held, f"Pick up {prop.name}")
        return
    _hold(bench, now)


def put_down(bench: Workbench) -> None:
    """Whoever holds the selected prop puts it down at the playhead; hands leave it."""
    document, prop_id = bench.document, selected_prop(bench)
    prop, now = document.project.props[prop_id or ""], document.playhead.time
    begun = [each for each in prop.holds if each.begin is None or each.begin < now]
    if prop_id is None or not begun:
        raise StudioError("Nobody holds the prop here. Select one that is held, and go to a later moment.")
    text = f"Put down {prop.name}"
    with document.group(text):
        document.replace("props", prop_id, prop.with_holds([*begun[:-1], replace(begun[-1], end=now)]), text)
        _leave(document, prop_id, begun[-1].performer_id, now, text)


def _leave(document: Document, prop_id: str, performer_id: str, now: float, text: str) -> None:
    """Hands of who lets go of a prop leave it."""
    for clip in document.project.performers[performer_id].clips:
        time = motion_time(clip, document.project.frame_rate_of(clip), now)
        for key, each in document.project.constraints_of(clip.motion_id).items():
            if _grips(each, prop_id, performer_id) and each.activation.at(time) > 0.0:
                curve = each.activation
                full = min(curve.full, time)
                left = ActivationCurve(min(curve.start, full), full, time, time + REACHING, curve.shape)
                document.replace("constraints", key, replace(each, activation=left), text)


def _grips(constraint: Constraint, prop_id: str, performer_id: str) -> bool:
    """Whether it keeps a hand of a performer on a prop."""
    follows = any(isinstance(each, FollowProp) and each.prop_id == prop_id for each in follows_of(constraint))
    return follows and constraint.scope.performer_id == performer_id


def _holding(bench: Workbench) -> tuple[Document, str, str]:
    """The selected prop, and the active performer, who plays something."""
    document, prop_id = bench.document, selected_prop(bench)
    performer_id = document.active_performer_id
    if prop_id is None or performer_id is None or document.active_clip is None:
        raise StudioError("Select a prop, while a body that is shown plays something.")
    return document, prop_id, performer_id


def _hold(bench: Workbench, begin: float | None) -> None:
    """Both hands hold the prop from ``begin`` on."""
    document, prop_id, performer_id = _holding(bench)
    prop, performer = document.project.props[prop_id], document.project.performers[performer_id]
    holder = posed_performers(document.project, bench.live.result, document.playhead.time).get(performer_id)
    hold = between_hands(prop, performer_id, holder) if holder else Carried(performer_id)
    text = f"{performer.name} {'holds' if begin is None else 'picks up'} {prop.name}"
    with document.group(text):
        if begin is not None:
            giver = prop.held_at(begin)
            document.replace("props", prop_id, prop.taken(hold, begin), text)
            if giver is not None and giver.performer_id != performer_id:
                _leave(document, prop_id, giver.performer_id, begin, text)
        elif not isinstance(prop.held, Carried) or prop.holders != {performer_id}:
            document.replace("props", prop_id, prop.with_holds([hold]), text)
        for motion_id, seconds in _stretches(document.project, performer, begin).items():
            others = document.project.constraints_of(motion_id)
            for key, each in others.items():
                if _grips(each, prop_id, performer_id) and (begin is None or each.activation.end > seconds[0]):
                    document.remove("constraints", key, text)
            others = document.project.constraints_of(motion_id)
            last = max((each.priority for each in others.values()), default=-1) + 1
            document.add_all("constraints", grips(motion_id, performer_id, prop_id, prop, seconds, last), text)


def _stretches(project: Project, performer: Performer, begin: float | None) -> dict[str, tuple[float, float]]:
    """Seconds, from and to, of each motion that a performer plays after ``begin``.

    Without a motion of which it has played the same before: there its hands would be asked for, too.
    """
    stretches: dict[str, tuple[float, float]] = {}
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        if begin is None or clip.start + clip.length(rate) > begin:
            first = clip.first / rate if begin is None else motion_time(clip, rate, begin)
            known = stretches.get(clip.motion_id, (first, first))
            stretches[clip.motion_id] = min(first, known[0]), max(clip.last / rate, known[1])
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        over = begin is not None and clip.start + clip.length(rate) <= begin
        if over and clip.motion_id in stretches and clip.last / rate > stretches[clip.motion_id][0]:
            del stretches[clip.motion_id]
    return stretches
