"""Every kind of the studio has the parts that its registration names."""

import pytest

from studio.core.constraints.kinds import BUILT_IN_KINDS, ConstraintKind
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.viewport import handle_figures, new_constraints
from studio.viewport.movables import MovableTarget


@pytest.mark.parametrize("kind", BUILT_IN_KINDS, ids=lambda kind: kind.value.kind)
def test_the_parts_of_a_kind_are_found_by_its_name(kind: ConstraintKind) -> None:
    name = kind.value.kind
    assert kind.task() is None or isinstance(kind.task(), SolverKind)
    assert kind.editor is not None
    assert issubclass(kind.editor(), ConstraintEditor)
    assert kind.target is None or issubclass(kind.target(), MovableTarget)
    assert callable(getattr(new_constraints, f"new_{name}"))
    assert hasattr(handle_figures, f"{name}_figure") == (kind.figure is not None)
