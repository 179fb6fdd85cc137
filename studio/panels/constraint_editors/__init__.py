"""Forms for constraints, found by kind; a kind without one gets the form that all kinds share."""

from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.position import PositionEditor

EDITORS: dict[str, type[ConstraintEditor]] = {"position": PositionEditor}


def editor_of_kind(kind: str) -> type[ConstraintEditor]:
    """The form for a kind of constraint."""
    return EDITORS.get(kind, ConstraintEditor)
