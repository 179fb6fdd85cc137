"""Object that the gizmo edits, from the selection, and the gizmo of a tool."""

from collections.abc import Callable, Mapping

import numpy as np

from studio.core.stage.placement import Placement
from studio.document.document import Document
from studio.engine.posed_performer import PosedPerformer
from studio.engine.target_context import TargetContext
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.gizmo import Gizmo, Space
from studio.viewport.handles import floor_under
from studio.viewport.movables import Movable, PlacedPerformer, PlacedProp, SelectedTogether
from studio.viewport.rotate_gizmo import RotateGizmo
from studio.viewport.rotated_targets import target_of_kind
from studio.viewport.scale_gizmo import ScaleGizmo

KIND_WORDS = {"performers": "characters", "constraints": "targets"}
"""Words for several objects of a collection, if its name does not suit users."""
AnyGizmo = Gizmo | RotateGizmo | ScaleGizmo


def selected_movable(
    document: Document, posed: Mapping[str, PosedPerformer], *, picking: bool = False
) -> Movable | None:
    """Object that the gizmo edits: the current selection, together with the other selected objects of its kind. None if
    it cannot be moved.

    A performer cannot be moved while one of its joints is picked, because the handles would overlap.
    """
    collection, current = document.selection.current or ("", "")
    if picking and collection == "performers":
        return None
    lead = _movable(document, posed, collection, current)
    if lead is None:
        return None
    selected = document.selection.of(collection)
    found = [_movable(document, posed, collection, key) for key in selected if key != current]
    others = [each for each in found if each is not None]
    words = f"{len(others) + 1} {KIND_WORDS.get(collection, collection)}"
    return SelectedTogether(document, words, lead, others) if others else lead


def _movable(
    document: Document, posed: Mapping[str, PosedPerformer], collection: str, entity_id: str
) -> Movable | None:
    """Prop, performer or target as a ``Movable``; None if it is hidden or has no position."""
    project, active = document.project, posed.get(document.active_performer_id or "")
    if collection == "props" and entity_id in project.props:
        return PlacedProp(document, entity_id, posed)
    if collection == "performers" and entity_id in posed:
        pose = posed[entity_id]
        return PlacedPerformer(document, entity_id, pose, floor_under(project, pose))
    constraint = project.constraints.get(entity_id) if collection == "constraints" else None
    if active is None or constraint is None or constraint.motion_id != active.motion_id:
        return None
    moment, floor = TargetContext(project, posed, active), floor_under(project, active)
    now = moment.with_targets_fixed(moment.as_played(constraint))
    if now is None:
        return None
    kind = target_of_kind(now)
    return kind(document, entity_id, moment, floor) if kind.is_held(now) else None


def gizmo_of(
    tool: str, movable: Movable, space: Space, camera: OrbitCamera, size: tuple[float, float], pixels: float
) -> AnyGizmo | None:
    """Gizmo of a tool (``move``, ``rotate`` or ``scale``) with arrows of ``pixels``; None if the tool does not apply to
    the object.
    """
    axes = axes_in(movable, space, camera).T
    if tool == "move" and movable.moves:
        return Gizmo(movable.placement.to_stage(movable.place), axes, camera, size, pixels, movable.flat)
    if tool == "rotate" and movable.rotates:
        return RotateGizmo(movable.pivot, axes, camera, size, pixels, movable.heading_only)
    if tool == "scale" and any(movable.scales):
        origin = movable.placement.to_stage(movable.place)
        return ScaleGizmo(origin, movable.own_axes.T, camera, size, pixels, movable.scales)
    return None


def axes_in(movable: Movable, space: Space, camera: OrbitCamera) -> FloatArray:
    """(3, 3) axes of an orientation as columns, stage space; horizontal for objects that stay on the ground."""
    makers: dict[Space, Callable[[], FloatArray]] = {
        Space.WORLD: lambda: np.eye(3),
        Space.LOCAL: lambda: movable.own_axes,
        Space.PARENT: lambda: movable.parent_axes,
        Space.SCREEN: lambda: camera.axes.T,
    }
    axes = makers[space]()
    if not movable.flat:
        return axes
    return Placement(heading=float(np.arctan2(axes[1, 0], axes[0, 0]))).rotation


def rotation_reference(movable: Movable, space: Space) -> FloatArray | None:
    """(3,) stage position from which snapping steps count; None for the object's own position."""
    if space is Space.WORLD:
        return np.zeros(3)
    is_fixed = space is Space.PARENT and np.allclose(movable.parent_axes, movable.placement.rotation)
    return movable.placement.to_stage(np.zeros(3)) if is_fixed else None
