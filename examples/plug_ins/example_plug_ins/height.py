"""A kind of constraint: a point stays at a height, wherever it goes over the ground."""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from studio import api


@dataclass(frozen=True)
class HeightConstraint(api.Constraint):
    """``point`` is ``height`` metres above the origin of the motion's space."""

    kind: ClassVar[str] = "example_height"
    shown: ClassVar[api.KindInfo] = api.KindInfo(
        "Keep at height", "Keep the picked joint at its height", "#9FC0A0", picks=True
    )
    height: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not math.isfinite(self.height):
            raise ValueError(f"'{self.name}': a height is a finite number of metres, got {self.height}.")

    @property
    def plane(self) -> api.AreaConstraint:
        """The same as an area: a level plane on whose surface the point stays."""
        return api.AreaConstraint(
            self.motion_id, self.name, self.point, self.chain, self.priority, self.activation,
            shape="half_space", centre=(0.0, 0.0, self.height), size=(0.0, 0.0, 1.0), on_surface=True,
        )  # fmt: skip

    def sketch(self, place: np.ndarray, turn: np.ndarray) -> tuple[np.ndarray, ...]:
        """A ring at the height, over the point."""
        angles = np.linspace(0.0, 2 * np.pi, 49)
        ring = 0.15 * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
        return (ring + np.array([place[0], place[1], self.height]),)


def task() -> Any:
    """The solver's part: the task of areas, written from the plane, and a residual of its own."""
    from studio.core.solver.task_assembly.kinds.area import AREA_KIND
    from studio.core.solver.task_assembly.posed_points import point_positions

    def write_task(rows: Any, c: int, constraint: HeightConstraint) -> None:
        AREA_KIND.write_task(rows, c, constraint.plane)

    def residual(constraint: HeightConstraint, _targets: Any, adapted: Any) -> np.ndarray:
        return np.abs(point_positions(constraint.point, adapted)[:, 2] - constraint.height)

    return replace(AREA_KIND, write_task=write_task, residual=residual)


def make(here: Any) -> HeightConstraint:
    """A new one at the picked joint."""
    joint = here.picked
    common = here.common(f"{joint.name.capitalize()} at height", joint.point, joint.chain)
    return HeightConstraint(**common, height=float(here.place(joint.point)[2]))


def editor() -> type:
    """Its form: a number."""
    from studio.panels.constraint_editors.common import ConstraintEditor
    from studio.panels.fields import NumberField

    class HeightEditor(ConstraintEditor):
        kind_words = "height"

        def add_kind_rows(self, section: Any) -> None:
            self._height = self.bind(NumberField("Height", "m", -100.0, 100.0, 0.01, 3), self._set_height)
            section.add_row("Height", self._height)

        def refresh(self) -> None:
            super().refresh()
            if self.entity is not None:
                self._height.show_value(self.entity.height)

        def _set_height(self, height: float) -> None:
            self.change(f"Change height of {self.entity.name}", height=height)

    return HeightEditor


KIND = api.ConstraintKind(HeightConstraint, task, make, editor)
