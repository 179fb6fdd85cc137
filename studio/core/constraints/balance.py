"""Balance constraints: the centre of mass stays over a position on the ground, or over the support polygon."""

import math
from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import Constraint, KindInfo
from studio.core.constraints.target import Place, checked_place
from studio.core.plausible import PLACE_RANGE


@dataclass(frozen=True)
class Support:
    """Balance target: the motion's own centre of mass, moved to the nearest point in the support polygon.

    The polygon of soles, hands, knees and seat is shrunk by ``margin`` metres, at most to the middle line of a sole.
    """

    kind: ClassVar[str] = "support"
    margin: float = 0.02

    def __post_init__(self) -> None:
        if not (math.isfinite(self.margin) and self.margin >= 0.0):
            raise ValueError(f"The margin of the support polygon must be 0 or more metres, not {self.margin}.")
        PLACE_RANGE.check(self.margin, "The margin of the support polygon")


@dataclass(frozen=True)
class BalanceConstraint(Constraint):
    """Constraint that keeps the centre of mass over ``place`` or, for None, over its own path in the motion.

    ``place`` is two numbers in metres, a position, a keyed path or a followed target, all in motion space, or the
    support polygon. ``vertical`` also constrains the height, to that of the place or of the motion. ``point`` is not
    used. The residual is the distance, horizontal unless ``vertical``.
    """

    kind: ClassVar[str] = "balance"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add balance constraint", "Keep the centre of mass where it is in the source capture", "#5FB5A8",
        held_by="place", handle="place", about="whole body",
    )  # fmt: skip
    place: tuple[float, float] | Place | Support | None = None
    vertical: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        place = self.place
        if place is None or isinstance(place, Support):
            return
        if isinstance(place, tuple | list) and len(place) == 2:
            object.__setattr__(self, "place", tuple(float(number) for number in place))
            if not all(math.isfinite(number) for number in place):
                raise ValueError(f"'{self.name}': a position on the ground needs two finite numbers in metres.")
            PLACE_RANGE.check(place)
        else:
            object.__setattr__(self, "place", checked_place(place, self, "the position of a balance"))
