"""A root that is brought back to where planted feet are in reach, smoothly in time (METHOD (37))."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyLayout
from studio.core.kernels import layout as at
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.solver.standing.blends import hann_window

FloatArray = NDArray[np.float64]

SWEEPS = 3
"""Times that one leg after the other pulls."""


@dataclass(frozen=True, eq=False)
class RootReach:
    """What holds the root of F unsolved poses: its ``places`` (F, 3), the ``hips`` from there (2, F, 3), the ``ankles``
    (2, F, 3) on which they stand and the ``lengths`` (2, F) metres to which legs stretch, inf where they are free.
    """

    places: FloatArray
    hips: FloatArray
    ankles: FloatArray
    lengths: FloatArray

    @staticmethod
    def of(
        positions: FloatArray, measures: FloatArray, layout: BodyLayout, ankles: FloatArray, root_reaches: FloatArray
    ) -> "RootReach":
        """Of unsolved ``positions`` (F, P, 3); ``root_reaches`` (2, F) parts of the legs, which let hips be where
        the motion itself has them.
        """
        hips = np.stack([positions[:, layout.hip(side)] for side in range(2)])
        legs = measures[:, at.M_LEG : at.M_LEG + 4].reshape(-1, 2, 2).sum(axis=2).T
        own = np.linalg.norm(hips - ankles[..., :3], axis=2)
        return RootReach(positions[:, 0], hips - positions[:, 0], ankles[..., :3], np.maximum(root_reaches * legs, own))

    def pulled(self, states: FloatArray, joints: NDArray[np.void], width: int) -> FloatArray:
        """(F, 3) by how much the root must come back when joints (N, 5) are at ``states`` (F, N, 3).

        What is missing is taken at its greatest over ``width`` frames on either side, and averaged over as many.
        """
        back = np.zeros_like(self.places)
        found = np.flatnonzero(joints["segment"] == ROOT_TRANSLATION)
        if not len(found):
            return back
        pelvis, hips = np.flatnonzero(joints["segment"] == 0), self.hips
        if len(pelvis):
            gibbs = states[:, pelvis[0]]
            turns = Rotation.from_quat(np.concatenate([gibbs, np.ones((len(gibbs), 1))], axis=1))
            hips = np.stack([turns.apply(each) for each in hips])
        root = self.places + states[:, found[0]]
        for _ in range(SWEEPS):
            for side in range(2):
                way = self.ankles[side] - (root + back + hips[side])
                span = np.linalg.norm(way, axis=1)
                over = np.where(np.isfinite(self.lengths[side]), span - self.lengths[side], 0.0)
                most = maximum_filter1d(np.maximum(over, 0.0), 2 * width + 1, mode="nearest")
                share = np.convolve(np.pad(most, width, mode="edge"), hann_window(width), mode="valid")
                back += share[:, None] * way / np.maximum(span, 1e-9)[:, None]
        return back
