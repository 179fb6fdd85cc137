"""Automatic framing: the camera moves when new performers would be outside of the view."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from studio.engine.posed_performer import PosedPerformer
from studio.viewport.camera import OrbitCamera
from studio.viewport.opening import clear_of_overlays

Size = tuple[float, float]
FRAMING_MARGIN = 0.06
"""Margin along the edges of the image, as a fraction of its width and height, in which bodies count as badly
visible.
"""


@dataclass(frozen=True)
class CameraStep:
    """Camera before and after it was moved for new performers."""

    arrived: frozenset[str]
    before: OrbitCamera
    after: OrbitCamera


class AutoFraming:
    """Memory of the known performers; when an import is undone, the camera moves back unless the user has moved it."""

    def __init__(self) -> None:
        self._known = frozenset[str]()
        self._step: CameraStep | None = None

    def note_performers(self, bodies: Collection[str]) -> None:
        """Record the performers when a stage is first shown."""
        self._known, self._step = frozenset(bodies), None

    def camera_for(
        self, performers: Collection[str], bodies: Mapping[str, PosedPerformer], camera: OrbitCamera, size: Size
    ) -> OrbitCamera:
        """Camera moved so that performers that are new since the last call are visible, never closer than before.

        It is unchanged if all new ones are visible; bodies that were mostly visible stay visible.
        """
        before, self._known = self._known, (self._known | bodies.keys()) & frozenset(performers)
        step = self._step
        if step is not None and step.arrived.isdisjoint(performers):
            self._step = None
            return step.before if camera == step.after else camera
        new = bodies.keys() - before
        if all(is_in_picture(bodies[key], camera, size) for key in new):
            return camera
        shown = {
            key: body for key, body in bodies.items() if key in new or visible_fraction(body, camera, size, 0.0) > 0.5
        }
        points = np.concatenate([body.points for body in shown.values()])
        framed = camera.framing(points, size)
        framed = clear_of_overlays(replace(framed, distance=max(framed.distance, camera.distance)), points, size)
        self._step = CameraStep(frozenset(new), camera, framed)
        return framed


def is_in_picture(body: PosedPerformer, camera: OrbitCamera, size: Size) -> bool:
    """True if a whole body is in the image, and not in the margin along its edges."""
    return visible_fraction(body, camera, size, FRAMING_MARGIN) == 1.0


def visible_fraction(body: PosedPerformer, camera: OrbitCamera, size: Size, edge: float) -> float:
    """Fraction of a body's points in the image without a margin ``edge``, a fraction of its width and height."""
    pixels, depth = camera.project(body.points, size)
    place = pixels / size
    return float(((depth > 0.0) & (place >= edge).all(axis=1) & (place <= 1.0 - edge).all(axis=1)).mean())
