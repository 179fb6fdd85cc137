"""The form of a look-at constraint: what is looked at."""

from studio.panels.constraint_editors.position import PositionEditor


class LookAtEditor(PositionEditor):
    """The place that is looked at, in metres, as a position's target."""
