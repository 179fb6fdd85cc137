"""Forms of constraints by kind; a kind without its own form gets the common one."""

from studio.core.constraints.base import Constraint
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.panels.constraint_editors.common import ConstraintEditor


def editor_of_kind(kind: str) -> type[ConstraintEditor[Constraint]]:
    """Class of the form for a kind of constraint."""
    known = CONSTRAINT_KINDS.get(kind)
    editor: type[ConstraintEditor[Constraint]] = known.editor() if known and known.editor else ConstraintEditor
    return editor
