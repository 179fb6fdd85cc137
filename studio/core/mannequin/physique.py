"""Physique: the proportions and girths of which a morphology and a mannequin are made.

Fractions of stature after Drillis and Contini (1966) as given by Winter (2009), joint centres after de Leva (1996).
"""

from dataclasses import dataclass

import numpy as np

from studio.core.body.morphology import Morphology

SPINE_FRACTIONS = np.array([0.17, 0.22, 0.25, 0.36])
"""Fractions of the height from root to neck base: pelvis, lower abdomen, upper abdomen, thorax."""
SPINE_SWAY = np.array([-0.004, 0.003, -0.012, -0.006])
"""Forward component of each spine vector as a fraction of stature, which curves the loins and the back."""


@dataclass(frozen=True)
class Physique:
    """Physique of a person: stature in metres, proportions as fractions of stature, and girths as factors on an average
    man's.
    """

    stature: float
    hip_height: float = 0.520
    thigh_share: float = 0.500
    """Length of the thigh as a fraction of the distance from hip to ankle."""
    ankle_height: float = 0.040
    neck: float = 0.056
    head: float = 0.088
    shoulder_width: float = 0.218
    """Between the shoulder joints."""
    shoulder_drop: float = 0.056
    """From the neck base down to where the clavicles begin."""
    hip_width: float = 0.102
    """Between the hip joints."""
    upper_arm: float = 0.172
    forearm: float = 0.150
    hand: float = 0.106
    foot_length: float = 0.152
    skull: float = 1.0
    jaw: float = 1.0
    """Prominence of jaw, chin, brow and nose."""
    neck_girth: float = 1.0
    chest: float = 1.0
    chest_depth: float = 1.0
    waist: float = 1.0
    belly: float = 0.0
    hips: float = 1.0
    seat: float = 1.0
    bust: float = 0.0
    pectorals: float = 1.0
    shoulders: float = 1.0
    arms: float = 1.0
    forearms: float = 1.0
    thighs: float = 1.0
    calves: float = 1.0
    hand_girth: float = 1.0
    foot_girth: float = 1.0

    def morphology(self) -> Morphology:
        """Measures of this body in metres, equal on both sides."""
        h = self.stature
        leg = h * (self.hip_height - self.ankle_height)
        root_above_hips = 0.022 * h
        trunk = h * (1 - self.hip_height - self.neck - self.head) - root_above_hips
        foot = h * self.foot_length
        ankle, ball = h * self.ankle_height, 0.115 * foot
        mirror = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0]])
        collar = np.array([0.026, 0.016, -self.shoulder_drop]) * h
        clavicle_outward = 0.9796  # the y part of the resting clavicle's direction
        return Morphology(
            spine=np.stack([SPINE_SWAY * h, np.zeros(4), SPINE_FRACTIONS * trunk], axis=1),
            neck=self.neck * h,
            head=self.head * h,
            collar_base=collar * mirror,
            clavicle=np.full(2, (self.shoulder_width * h / 2 - collar[1]) / clavicle_outward),
            arm=np.tile(h * np.array([self.upper_arm, self.forearm]), (2, 1)),
            hand=np.tile([0.0, 0.0, h * self.hand], (2, 1)),
            hip_offset=np.array([0.0, self.hip_width * h / 2, -root_above_hips]) * mirror,
            leg=np.tile(leg * np.array([self.thigh_share, 1 - self.thigh_share]), (2, 1)),
            foot=np.array([0.48 * foot, 0.03 * foot, ball - ankle]) * mirror,
            toe=np.array([0.25 * foot, 0.0, -0.3 * ball]) * mirror,
            ankle_height=np.full(2, ankle),
            toe_height=np.full(2, ball),
            heel_length=np.full(2, 0.24 * foot),
        )
