"""Forms for constraints, found by kind; a kind without one gets the form that all kinds share."""

from typing import cast

from studio.core.constraints.kinds import ADDED_KINDS
from studio.panels.constraint_editors.area import AreaEditor
from studio.panels.constraint_editors.balance import BalanceEditor
from studio.panels.constraint_editors.clear import ClearEditor
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.distance import DistanceEditor
from studio.panels.constraint_editors.look_at import LookAtEditor
from studio.panels.constraint_editors.orientation import OrientationEditor
from studio.panels.constraint_editors.parallel import ParallelEditor
from studio.panels.constraint_editors.position import PositionEditor
from studio.panels.constraint_editors.rail import RailEditor
from studio.panels.constraint_editors.upright import UprightEditor

CONSTRAINT_EDITORS: dict[str, type[ConstraintEditor]] = {
    "position": PositionEditor,
    "orientation": OrientationEditor,
    "look_at": LookAtEditor,
    "upright": UprightEditor,
    "parallel": ParallelEditor,
    "distance": DistanceEditor,
    "balance": BalanceEditor,
    "area": AreaEditor,
    "rail": RailEditor,
    "clear": ClearEditor,
}


def editor_of_kind(kind: str) -> type[ConstraintEditor]:
    """The form for a kind of constraint."""
    added = ADDED_KINDS.get(kind)
    if added is not None and added.editor is not None:
        return cast("type[ConstraintEditor]", added.editor())
    return CONSTRAINT_EDITORS.get(kind, ConstraintEditor)
