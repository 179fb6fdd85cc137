"""Skeleton: the joints of a body, their hierarchy, and the bones at rest."""

from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Skeleton:
    """Joints in an order with every parent before its children; joint 0 is the only root.

    Raises StudioError if the joints do not form one tree, share a name, or have an offset that is not finite.
    """

    names: tuple[str, ...]
    parents: IntArray
    """Index (J,) of the parent of each joint; -1 for the root."""
    offsets: FloatArray
    """Offsets (J, 3) in metres from the parent joint, in its axes; that of the root is its position at rest."""
    end_sites: BoolArray
    """Mask (J,) of the ends of bones, which have no motion of their own."""

    def __post_init__(self) -> None:
        count = len(self.names)
        for field, kind, shape in (
            ("parents", np.int64, (count,)),
            ("offsets", np.float64, (count, 3)),
            ("end_sites", np.bool_, (count,)),
        ):
            array = np.array(getattr(self, field), dtype=kind)
            if array.shape != shape:
                raise StudioError(f"A skeleton of {count} joints needs {field} of shape {shape}, not {array.shape}.")
            array.setflags(write=False)
            object.__setattr__(self, field, array)
        self._check()

    def _check(self) -> None:
        if not self.names:
            raise StudioError("A skeleton needs at least one joint.")
        if len(set(self.names)) != len(self.names):
            twice = next(name for name in self.names if self.names.count(name) > 1)
            raise StudioError(f"Two joints of the skeleton are called '{twice}'. Every joint needs a name of its own.")
        if self.parents[0] != -1:
            raise StudioError("The first joint of a skeleton must be its root.")
        below = np.arange(1, len(self.names))
        wrong = below[(self.parents[1:] < 0) | (self.parents[1:] >= below)]
        if len(wrong):
            raise StudioError(f"Joint '{self.names[wrong[0]]}' comes before its parent in the skeleton.")
        if not np.isfinite(self.offsets).all():
            joint = int(np.argmin(np.isfinite(self.offsets).all(axis=1)))
            raise StudioError(f"The offset of joint '{self.names[joint]}' is not a finite number.")

    @property
    def joint_count(self) -> int:
        """Number of joints J, end sites included."""
        return len(self.names)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """Children of each joint."""
        lists: list[list[int]] = [[] for _ in self.names]
        for joint, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                lists[parent].append(joint)
        return tuple(map(tuple, lists))

    @cached_property
    def depths(self) -> tuple[int, ...]:
        """Number of ancestors of each joint."""
        depths: list[int] = []
        for parent in self.parents.tolist():
            depths.append(0 if parent < 0 else depths[parent] + 1)
        return tuple(depths)

    def index(self, name: str) -> int:
        """Index of the joint called ``name``. Raises StudioError, which suggests similar names."""
        if name in self.names:
            return self.names.index(name)
        near = get_close_matches(name, self.names, n=4, cutoff=0.5) or self.names[:4]
        raise StudioError(f"No joint is called '{name}'. Nearest names: {', '.join(near)}.")

    def path(self, ancestor: int, joint: int) -> tuple[int, ...]:
        """Joints from ``ancestor`` down to ``joint``, both included; empty if ``ancestor`` is none of the joint."""
        way = [joint]
        while way[-1] > ancestor:
            way.append(int(self.parents[way[-1]]))
        return tuple(reversed(way)) if way[-1] == ancestor else ()

    def common_ancestor(self, *joints: int) -> int:
        """Deepest joint that is an ancestor of all ``joints``, or one of them."""
        current = set(joints)
        while len(current) > 1:
            deepest = max(current)
            current = (current - {deepest}) | {int(self.parents[deepest])}
        return current.pop()

    def descendants(self, joint: int) -> tuple[int, ...]:
        """All descendants of ``joint``, end sites included, without the joint itself."""
        below = {joint}
        for other in range(joint + 1, self.joint_count):
            if int(self.parents[other]) in below:
                below.add(other)
        return tuple(sorted(below - {joint}))
