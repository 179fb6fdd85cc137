"""Roles: positions of markers on a body, independent of the labels of a marker set."""

from dataclasses import dataclass

SIDE_WORDS = ("left", "right")
JOINTS = tuple(
    f"{side}_{joint}" for side in SIDE_WORDS for joint in ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
)
"""Names of the joints with centres."""


@dataclass(frozen=True)
class MarkerRole:
    """Role of a marker: its position on the body, named by the anatomy under the skin there."""

    id: str
    words: str
    part: str
    """Part of the body: ``head``, ``trunk``, ``pelvis``, ``left arm``, ``right leg`` ..."""
    spot: tuple[float, float]
    """Position on a figure: across from -1 (the right of the body) to 1 (its left), up from 0 (soles) to 1 (crown)."""
    hint: str


def _pair(name: str, words: str, limb: str, spot: tuple[float, float], hint: str) -> tuple[MarkerRole, ...]:
    part = {"arm": "{} arm", "leg": "{} leg"}.get(limb, limb)
    return tuple(
        MarkerRole(f"{side}_{name}", f"{side.capitalize()} {words}", part.format(side), (sign * spot[0], spot[1]), hint)
        for side, sign in zip(SIDE_WORDS, (1.0, -1.0), strict=True)
    )


ROLES: tuple[MarkerRole, ...] = (
    *_pair("front_head", "forehead", "head", (0.09, 0.955), "Left or right on the forehead or temple"),
    *_pair("back_head", "back of the head", "head", (0.16, 0.935), "At the height of the forehead's, behind"),
    MarkerRole("neck_back", "Neck (C7)", "trunk", (0.0, 0.865), "The vertebra that stands out at the foot of the neck"),
    MarkerRole("collar", "Collar (notch)", "trunk", (0.0, 0.815), "Between the collar bones, in front"),
    MarkerRole("breastbone", "Breastbone", "trunk", (0.0, 0.715), "The lower end of the breastbone, in front"),
    MarkerRole("back", "Back (T10)", "trunk", (0.0, 0.655), "On the spine, as high as the breastbone's end"),
    *_pair("front_hip", "front of the pelvis", "pelvis", (0.14, 0.545), "The bone in front, under the belt (ASIS)"),
    *_pair("back_hip", "back of the pelvis", "pelvis", (0.05, 0.575), "Dimple behind (PSIS); a sacrum marker is both"),
    *_pair("shoulder", "shoulder", "arm", (0.23, 0.815), "On top of the shoulder"),
    *_pair("upper_arm", "upper arm", "arm", (0.33, 0.725), "Anywhere on the upper arm"),
    *_pair("elbow", "elbow", "arm", (0.43, 0.655), "The outer side of the elbow"),
    *_pair("inner_elbow", "inner elbow", "arm", (0.35, 0.63), "The inner side of the elbow"),
    *_pair("forearm", "forearm", "arm", (0.47, 0.585), "Anywhere on the forearm"),
    *_pair("wrist", "wrist, thumb", "arm", (0.505, 0.53), "The thumb's side of the wrist"),
    *_pair("outer_wrist", "wrist, little finger", "arm", (0.575, 0.545), "The little finger's side of the wrist"),
    *_pair("hand", "hand", "arm", (0.575, 0.465), "On the hand, near the fingers"),
    *_pair("hip", "hip joint", "leg", (0.2, 0.5), "Beside the hip joint; where the pelvis has no markers"),
    *_pair("thigh", "thigh", "leg", (0.19, 0.41), "Anywhere on the thigh, best on its outer side"),
    *_pair("knee", "knee", "leg", (0.18, 0.3), "The outer side of the knee"),
    *_pair("inner_knee", "inner knee", "leg", (0.055, 0.3), "The inner side of the knee"),
    *_pair("shank", "shank", "leg", (0.17, 0.195), "Anywhere on the shank, best on its outer side"),
    *_pair("ankle", "ankle", "leg", (0.165, 0.085), "The outer side of the ankle"),
    *_pair("inner_ankle", "inner ankle", "leg", (0.06, 0.085), "The inner side of the ankle"),
    *_pair("heel", "heel", "leg", (0.09, 0.035), "Behind, on the heel"),
    *_pair("toe", "toes", "leg", (0.2, 0.02), "Over the ball of the foot, before the second toe"),
    *_pair("inner_toe", "ball of the big toe", "leg", (0.13, 0.01), "The head of the first metatarsal"),
    *_pair("big_toe", "tip of the big toe", "leg", (0.165, -0.005), "On the nail or the tip of the big toe"),
    *_pair("outer_toe", "ball of the little toe", "leg", (0.27, 0.01), "The head of the fifth metatarsal"),
)  # fmt: skip
"""All roles, in the order of the form."""

ROLES_BY_ID: dict[str, MarkerRole] = {role.id: role for role in ROLES}
"""Roles by their ids."""
