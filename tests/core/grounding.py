"""Adaptation of one motion to one body under many sets of constraints: grounded once for all of them."""

from dataclasses import replace
from functools import lru_cache

from studio.core.solver.adapt import grounded_motion, solve_request
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest


class _Grounding:
    """Key of a grounded motion: a request by all its values but constraints, tracks and smoothing."""

    def __init__(self, request: AdaptRequest) -> None:
        self.request = replace(request, constraints=(), tracks={}, final_tracks={}, eased=False)
        self.values = tuple(value for name, value in vars(self.request).items() if not name.endswith("tracks"))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Grounding) and self.values == other.values

    def __hash__(self) -> int:
        return hash(self.values)


@lru_cache(maxsize=32)
def _standing(grounding: _Grounding) -> GroundedMotion:
    return grounded_motion(grounding.request)


def adapt_again(request: AdaptRequest, first: int = 0, last: int | None = None) -> AdaptedMotion:
    """Adapted motion of ``request``, as ``adapt`` finds it, on a grounded motion kept from the last such request."""
    return solve_request(_standing(_Grounding(request)), request, first, last)
