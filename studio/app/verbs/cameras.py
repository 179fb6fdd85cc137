"""Actions of saved cameras: store, look through, turntable."""

from collections.abc import Callable

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.document.stored_cameras import camera_in_slot, store_camera
from studio.panels.message_strip import Lifetime


def slot_recaller(slot: int) -> Callable[[Workbench], None]:
    """Function of the action that looks through the camera in a slot. It raises StudioError if the slot is empty."""

    def run(bench: Workbench) -> None:
        camera_id = camera_in_slot(bench.document.project, slot)
        if camera_id is None:
            raise StudioError(f"Camera slot {slot} is empty. Store the view with View > Store camera {slot}.")
        bench.viewport.look_through(bench.document.project.cameras[camera_id].placement)

    return run


def slot_storer(slot: int) -> Callable[[Workbench], None]:
    """Function of the action that stores the current view in a slot."""

    def run(bench: Workbench) -> None:
        camera_id = store_camera(bench.document, bench.viewport.placement, slot)
        bench.inform(f"The view is stored as {bench.document.project.cameras[camera_id].name}.", until=Lifetime.EDITED)

    return run


def add(bench: Workbench) -> None:
    """Save the current view as a new camera, and show its form."""
    camera_id = store_camera(bench.document, bench.viewport.placement)
    bench.document.selection.set(("cameras", camera_id))


def choose(bench: Workbench) -> None:
    """Let the user choose a saved camera, look through it, and show its form."""
    cameras = bench.document.project.cameras
    if not cameras:
        raise StudioError("No camera is saved yet. Save the view with View > Add camera.")

    def looker(camera_id: str) -> Callable[[], None]:
        def look() -> None:
            bench.viewport.look_through(bench.document.project.cameras[camera_id].placement)
            bench.document.selection.set(("cameras", camera_id))

        return look

    bench.window.choose(
        "Look through camera",
        [((each.name, f"slot {each.slot}" if each.slot else ""), looker(key)) for key, each in cameras.items()],
    )


def toggle_turntable(bench: Workbench) -> None:
    """Start or stop the turntable."""
    bench.viewport.set_turntable(not bench.viewport.turntable)
