"""Animation of a glTF file, sampled at evenly spaced times."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.rotations import normalized, slerp
from studio.io.gltf.accessors import Accessors
from studio.io.json_record import Record

FloatArray = NDArray[np.float64]

_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
_LONGEST = 1e6
_NO_TURN = 1e-6
"""Length below which a quaternion is no rotation."""
_STEP_SLACK = 1e-3
"""Seconds by which a key of steps may lie behind a frame that shows it: times are written with 24 bits."""


@dataclass(frozen=True, eq=False)
class AnimationTrack:
    """Keys of one property of one node."""

    node: int
    path: str
    """``translation``, ``rotation`` or ``scale``."""
    times: FloatArray
    """Times (K,) in seconds, ascending."""
    values: FloatArray
    """Values (K, 3) or (K, 4); for cubic splines (K, 3, width): incoming tangent, value, outgoing tangent."""
    interpolation: str

    def at(self, times: FloatArray) -> FloatArray:
        """Values (F, width) at ``times`` in seconds, constant outside the first and the last key."""
        after = np.clip(np.searchsorted(self.times, times, side="right"), 1, max(len(self.times) - 1, 1))
        before = after - 1
        if len(self.times) == 1:
            after = before
        span = self.times[after] - self.times[before]
        share = np.clip((times - self.times[before]) / np.where(span > 0.0, span, 1.0), 0.0, 1.0)
        if self.interpolation == "CUBICSPLINE":
            return self._spline(before, after, span, share)
        if self.interpolation == "STEP":
            last = np.searchsorted(self.times, times + _STEP_SLACK, side="right") - 1
            return self.values[np.maximum(last, 0)]
        if self.path == "rotation":
            return slerp(self.values[before], self.values[after], share)
        return self.values[before] + share[:, None] * (self.values[after] - self.values[before])

    def _spline(
        self, before: NDArray[np.int64], after: NDArray[np.int64], span: FloatArray, share: FloatArray
    ) -> FloatArray:
        """Cubic Hermite (glTF 2.0, appendix C.5)."""
        t, d = share[:, None], span[:, None]
        start, end = self.values[before], self.values[after]
        value = (2 * t**3 - 3 * t**2 + 1) * start[:, 1] + d * (t**3 - 2 * t**2 + t) * start[:, 2]
        value += (-2 * t**3 + 3 * t**2) * end[:, 1] + d * (t**3 - t**2) * end[:, 0]
        return normalized(value) if self.path == "rotation" else value


def read_tracks(animation: Record, accessors: Accessors, node_count: int, repairs: list[str]) -> list[AnimationTrack]:
    """Tracks of one animation that move nodes; keys without numbers are filled and listed in ``repairs``.

    Raises StudioError for invalid keys.
    """
    samplers = animation.records("samplers")
    tracks: list[AnimationTrack] = []
    lacking: list[float] = []
    for channel in animation.records("channels"):
        target = channel.inner("target")
        node, path = target.index("node", node_count), target.text("path")
        if node is None or path not in _WIDTHS:
            continue
        index = channel.index("sampler", len(samplers))
        if index is None:
            raise channel.value_error("sampler", "the number of a sampler")
        sampler = samplers[index]
        interpolation = sampler.text("interpolation", "LINEAR")
        if interpolation not in ("LINEAR", "STEP", "CUBICSPLINE"):
            raise sampler.value_error("interpolation", "LINEAR, STEP or CUBICSPLINE")
        keys, output = sampler.index("input", accessors.count), sampler.index("output", accessors.count)
        if keys is None or output is None:
            raise sampler.value_error("input and output", "the numbers of two accessors")
        times = accessors.numbers(keys, 1)[:, 0]
        values = accessors.numbers(output, _WIDTHS[path], missing=True)
        spline = interpolation == "CUBICSPLINE"
        if not len(times) or (np.diff(times) <= 0.0).any() or np.abs(times).max() > _LONGEST:
            raise sampler.value_error("input", "times that rise")
        if len(values) != len(times) * (3 if spline else 1):
            raise sampler.value_error("output", "a value for every time")
        values = values.reshape(len(times), 3 if spline else 1, -1)
        known = np.isfinite(values).all(axis=(1, 2))
        if path == "rotation" and not spline:
            known &= np.linalg.norm(values[:, 0], axis=1) > _NO_TURN
        if not known.any():
            raise sampler.value_error("output", f"numbers{', and rotations that are not zero' * (path == 'rotation')}")
        lacking += times[~known].tolist()
        every, times, values = times, times[known], values[known] if spline else values[known, 0]
        if path == "rotation" and not spline:
            values = normalized(values)
        if interpolation == "LINEAR" and len(times) < len(every):  # the rate of all keys stays as it is
            times, values = every, AnimationTrack(node, path, times, values, interpolation).at(every)
        tracks.append(AnimationTrack(node, path, times, values, interpolation))
    if lacking:
        count = "1 key lacks" if len(lacking) == 1 else f"{len(lacking)} keys lack"
        where = f"{animation.where}, {min(lacking):.3g} s"
        repairs.append(f"{where}: {count} numbers; what is missing was filled from the keys around.")
    return tracks
