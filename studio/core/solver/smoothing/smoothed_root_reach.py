"""Root displacement, smooth in time, that keeps planted feet in reach (METHOD (37))."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyLayout
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.solver.grounding.contact_blending import hann_window

FloatArray = NDArray[np.float64]

ROOT_SWEEPS = 3
"""Iterations over both legs."""


@dataclass(frozen=True, eq=False)
class RootReach:
    """Bounds of the root by planted feet in F unsolved poses."""

    root_positions: FloatArray
    """(F, 3) metres."""
    hips: FloatArray
    """(2, F, 3) offsets of both hips from the root, metres."""
    ankles: FloatArray
    """(2, F, 3) planted ankles, metres."""
    lengths: FloatArray
    """(2, F) greatest distances hip-ankle in metres, inf for free feet."""

    @staticmethod
    def of(
        positions: FloatArray, measures: FloatArray, layout: BodyLayout, ankles: FloatArray, root_reaches: FloatArray
    ) -> "RootReach":
        """Bounds of unsolved ``positions`` (F, P, 3).

        ``root_reaches`` (2, F) are extensions in leg lengths; the distance is at least the motion's own.
        """
        hips = np.stack([positions[:, layout.hip_point(side)] for side in range(2)])
        legs = measures[:, measure.LEG : measure.LEG + 4].reshape(-1, 2, 2).sum(axis=2).T
        own = np.linalg.norm(hips - ankles[..., :3], axis=2)
        return RootReach(positions[:, 0], hips - positions[:, 0], ankles[..., :3], np.maximum(root_reaches * legs, own))

    def root_correction(self, states: FloatArray, joints: NDArray[np.void], width: int) -> FloatArray:
        """Displacement (F, 3) in metres that brings the root of poses with ``states`` (F, N, 3) into reach of planted
        feet.

        It is the greatest shortage over ``width`` frames on either side, averaged over as many. ``joints`` (N,) are
        those of the search.
        """
        back = np.zeros_like(self.root_positions)
        found = np.flatnonzero(joints["segment"] == ROOT_TRANSLATION)
        if not len(found):
            return back
        pelvis, hips = np.flatnonzero(joints["segment"] == 0), self.hips
        if len(pelvis):
            gibbs = states[:, pelvis[0]]
            rotation_matrices = Rotation.from_quat(np.concatenate([gibbs, np.ones((len(gibbs), 1))], axis=1))
            hips = np.stack([rotation_matrices.apply(each) for each in hips])
        root = self.root_positions + states[:, found[0]]
        for _ in range(ROOT_SWEEPS):
            for side in range(2):
                displacement = self.ankles[side] - (root + back + hips[side])
                span = np.linalg.norm(displacement, axis=1)
                over = np.where(np.isfinite(self.lengths[side]), span - self.lengths[side], 0.0)
                most = maximum_filter1d(np.maximum(over, 0.0), 2 * width + 1, mode="nearest")
                fraction = np.convolve(np.pad(most, width, mode="edge"), hann_window(width), mode="valid")
                back += fraction[:, None] * displacement / np.maximum(span, 1e-9)[:, None]
        return back
