"""Form of a look-at constraint: the gaze target."""

from studio.panels.constraint_editors.position import PositionEditor


class LookAtEditor(PositionEditor):
    """Position of the gaze target in metres, as for a position constraint."""
