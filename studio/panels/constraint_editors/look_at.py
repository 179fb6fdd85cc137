"""Form of a look-at constraint: the gaze target."""

from studio.panels.constraint_editors.position import PositionEditor


class LookAtEditor(PositionEditor):
    """Form of a look-at constraint: position of the gaze target in metres."""
