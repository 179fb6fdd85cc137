"""Look-at constraints: a segment, usually the head, faces a target."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Constraint, KindInfo
from studio.core.constraints.target import Place, checked_place


@dataclass(frozen=True)
class LookAtConstraint(Constraint):
    """Constraint that points the x axis of the segment of ``point``, through this point, at ``target``.

    ``target`` is a fixed, keyed or followed position. The default point is between the eyes. The residual is an angle.
    """

    kind: ClassVar[str] = "look_at"
    unit: ClassVar[str] = "rad"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add look-at constraint",
        "Make the active character look at a position in front of it",
        "#8FA3E0",
        held_by="target",
    )
    target: Place = (1.0, 0.0, 1.5)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "target", checked_place(self.target, self, "a target"))


EYES_POINT = BodyPoint(BodyPart.HEAD, (0.08, 0.0, 0.09))
"""Point between the eyes of an average head."""
