"""Mouse events of the 3D view: drags, selection, and hovering."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QMouseEvent

from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.viewport import picking
from studio.viewport.mouse_gestures import CameraDrag, MoveDrag, RotateDrag, ScaleDrag
from studio.viewport.navigation import camera_drag
from studio.viewport.rotate_gizmo import RotateGizmo
from studio.viewport.scale_gizmo import ScaleGizmo
from studio.viewport.selected_movable import rotation_reference
from studio.viewport.skin_picking import skin_point_at

if TYPE_CHECKING:
    from studio.viewport.camera import OrbitCamera
    from studio.viewport.widget import Viewport

HANDLE_PICK_REACH = 11.0


def begin_gesture(viewport: Viewport, document: Document, live: Live, event: QMouseEvent) -> None:
    """Start a drag or select: the left button drags the gizmo, unless Alt is held; otherwise the navigation settings
    tell which buttons move the camera, and the left button picks or selects.
    """
    if viewport.gesture is not None:
        return
    x, y = event.position().x(), event.position().y()
    is_left = event.button() == Qt.MouseButton.LeftButton
    alt = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
    if is_left and not alt and not viewport.picks_skin and _grab_gizmo(viewport, document, live, x, y):
        return
    if is_left and not alt and viewport.picks_skin:
        picked = skin_point_at(document.project, viewport.posed, viewport.camera, viewport.view_size, x, y)
        if picked is not None:
            viewport.pick(picked)
        return
    kind = camera_drag(viewport.navigation, event.button(), event.modifiers())
    if kind:
        viewport.gesture = CameraDrag(kind, viewport.camera, viewport.view_size[1], x, y, viewport.set_camera)
    elif is_left:
        _select(viewport, document, x, y)


def update_hover(viewport: Viewport, event: QMouseEvent) -> None:
    """Continue the current drag, or update the highlight under the mouse."""
    x, y = event.position().x(), event.position().y()
    keys = event.modifiers()
    if viewport.gesture is not None:
        fine = bool(keys & Qt.KeyboardModifier.ShiftModifier)
        viewport.gesture.update(x, y, fine, bool(keys & Qt.KeyboardModifier.ControlModifier))
    else:
        _hover(viewport, x, y)


def _grab_gizmo(viewport: Viewport, document: Document, live: Live, x: float, y: float) -> bool:
    gizmo, movable, part = viewport.gizmo(), viewport.movable(), _gizmo_part(viewport, x, y)
    if gizmo is None or movable is None or part is None:
        return False
    viewport.gizmo_part_hovered = part
    steps = viewport.snap_steps
    match gizmo:
        case RotateGizmo():
            viewport.gesture = RotateDrag(document, live, movable, gizmo, part, x, y, steps)
        case ScaleGizmo():
            viewport.gesture = ScaleDrag(document, live, movable, gizmo, part, x, y, steps)
        case _:
            zero = rotation_reference(movable, viewport.gizmo_space)
            viewport.gesture = MoveDrag(document, live, movable, gizmo, part, x, y, steps, zero)
    return True


def _select(viewport: Viewport, document: Document, x: float, y: float) -> None:
    """Select the target, joint, performer or prop under the mouse, in this order; a click on nothing deselects.

    A reached target coincides with its joint, which is picked too, so that it can be constrained further.
    """
    where = (viewport.camera, viewport.view_size, x, y)
    handles = {f"{one.performer_id} {one.constraint_id}": one for one in viewport.handles()}
    near = picking.nearest_place(
        [(key, one.target) for key, one in handles.items() if one.target is not None], *where, HANDLE_PICK_REACH
    )
    joint = picking.joint_at(viewport.posed, *where)
    if near:
        handle = handles[near]
        viewport.pick(joint if joint and joint.performer_id == handle.performer_id else None)
        document.selection.set(("performers", handle.performer_id), ("constraints", handle.constraint_id))
    elif joint:
        viewport.pick(joint)
    else:
        viewport.pick(None)
        _select_body_or_prop(viewport, document, where)


def _select_body_or_prop(
    viewport: Viewport, document: Document, where: tuple[OrbitCamera, picking.Size, float, float]
) -> None:
    performer_id = picking.body_at(viewport.posed, *where)
    prop_id = None if performer_id else picking.prop_under(viewport.props, *where)
    if performer_id:
        document.selection.set(("performers", performer_id))
    elif prop_id:
        document.selection.set(("props", prop_id))
    else:
        document.selection.clear()


def _gizmo_part(viewport: Viewport, x: float, y: float) -> str | None:
    """Part of the gizmo under the mouse; joints at a performer's feet come before its gizmo. None if there is none."""
    gizmo, movable = viewport.gizmo(), viewport.movable()
    part = gizmo.part_at(x, y) if gizmo is not None else None
    if part is None or movable is None or not movable.gives_way_to_joints:
        return part
    return None if picking.joint_at(viewport.posed, viewport.camera, viewport.view_size, x, y) else part


def _hover(viewport: Viewport, x: float, y: float) -> None:
    part = _gizmo_part(viewport, x, y)
    joint = None if part else picking.joint_at(viewport.posed, viewport.camera, viewport.view_size, x, y)
    body = joint.performer_id if joint else None
    if part is None and body is None:
        body = picking.body_at(viewport.posed, viewport.camera, viewport.view_size, x, y)
    if (part, joint, body) != (viewport.gizmo_part_hovered, viewport.joint_hovered, viewport.body_hovered):
        viewport.gizmo_part_hovered, viewport.joint_hovered, viewport.body_hovered = part, joint, body
        viewport.update()
