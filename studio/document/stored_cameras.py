"""Saved cameras of the stage, which a slot of the keyboard can recall."""

from dataclasses import replace

from studio.core.names import free_name
from studio.core.stage.project import Project
from studio.core.stage.saved_camera import CameraPlacement, SavedCamera
from studio.document.document import Document


def camera_in_slot(project: Project, slot: int) -> str | None:
    """Id of the camera in a slot; None if the slot is empty."""
    return next((key for key, each in project.cameras.items() if each.slot == slot), None)


def store_camera(document: Document, placement: CameraPlacement, slot: int | None = None) -> str:
    """Save a camera placement as one undo step, in place of that of the camera in ``slot`` if there is one. Returns the
    camera's id.
    """
    project = document.project
    known = camera_in_slot(project, slot) if slot is not None else None
    if known is not None:
        saved = replace(project.cameras[known], placement=placement)
        document.replace("cameras", known, saved, f"Store {saved.name}")
        return known
    others = {each.name for each in project.cameras.values()}
    name = free_name(f"Camera {slot}" if slot is not None else "Camera", others)
    return document.add("cameras", SavedCamera(name, placement, slot), f"Store {name}")


def give_slot(document: Document, camera_id: str, slot: int | None) -> None:
    """Assign a slot to a camera, and remove it from any other camera, as one undo step; None removes the camera's
    slot.
    """
    camera = document.project.cameras[camera_id]
    with document.group(f"Set shortcut of {camera.name}"):
        holder = camera_in_slot(document.project, slot) if slot is not None else None
        if holder is not None and holder != camera_id:
            other = document.project.cameras[holder]
            document.replace("cameras", holder, replace(other, slot=None), f"Set shortcut of {other.name}")
        document.replace("cameras", camera_id, replace(camera, slot=slot), f"Set shortcut of {camera.name}")
