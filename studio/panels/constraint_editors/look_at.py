"""Form of a look-at constraint: the gaze target."""

from studio.panels.constraint_editors.position import PositionEditor


class LookAtEditor(PositionEditor):
    """The place that is looked at, in metres, as a position's target."""
