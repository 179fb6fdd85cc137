"""New constraints: one verb for all kinds."""

from collections.abc import Callable

from studio.app.workbench import Workbench
from studio.core.errors import StudioError


def adder(kind: str) -> Callable[[Workbench], None]:
    """A verb that adds a constraint of ``kind`` at the joint picked in the viewport, or to the active body."""

    def add(bench: Workbench) -> None:
        if bench.viewport.add_constraint_at_pick(kind) is None:
            raise StudioError("Click a joint in the viewport first: that is what the constraint will be about.")

    return add
