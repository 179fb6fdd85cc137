"""A made body with markers whose joint centres are known: it walks in place, arms and legs swinging."""

import numpy as np

from studio.core.markers.cleaning import FloatArray
from studio.core.markers.marker_map import MarkerMap
from studio.core.markers.measures import Measures, SideMeasures
from studio.core.markers.trial import Trial

RATE, FRAMES = 100.0, 150
SIDES = {"left": 1.0, "right": -1.0}


def turned(axis: str, angles: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) about a world axis."""
    c, s, o, i = np.cos(angles), np.sin(angles), np.zeros_like(angles), np.ones_like(angles)
    rows = {"x": ((i, o, o), (o, c, -s), (o, s, c)), "y": ((c, o, s), (o, i, o), (-s, o, c))}[axis]
    return np.moveaxis(np.array(rows), -1, 0)


def made_body() -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Markers by role and true joint centres (F, 3), metres; markers lie 5 cm beside the joints."""
    time = np.arange(FRAMES) / RATE
    root = np.stack([0.8 * time, 0.02 * np.sin(6 * time), 0.95 + 0.01 * np.sin(12 * time)], axis=1)
    markers: dict[str, FloatArray] = {}
    joints: dict[str, FloatArray] = {}

    def put(at: FloatArray, axes: FloatArray, local: tuple[float, float, float]) -> FloatArray:
        return at + axes @ np.array(local)

    pelvis = turned("y", 0.05 * np.sin(6 * time))
    chest = turned("y", 0.1 + 0.03 * np.sin(6 * time))
    for side, out in SIDES.items():
        swing = out * np.sin(6 * time)
        markers[f"{side}_front_hip"] = put(root, pelvis, (0.1, 0.12 * out, 0.08))
        markers[f"{side}_back_hip"] = put(root, pelvis, (-0.09, 0.05 * out, 0.08))
        hip = put(root, pelvis, (0.0, 0.09 * out, 0.0))
        thigh = turned("y", -0.5 * swing)
        shank = turned("y", -0.5 * swing + 0.5 + 0.45 * np.sin(6 * time + out))
        knee, ankle = hip + thigh @ (0, 0, -0.42), hip + thigh @ (0, 0, -0.42) + shank @ (0, 0, -0.4)
        joints |= {f"{side}_hip": hip, f"{side}_knee": knee, f"{side}_ankle": ankle}
        markers[f"{side}_thigh"] = put(hip, thigh, (0.0, 0.09 * out, -0.2))
        markers[f"{side}_shank"] = put(knee, shank, (0.0, 0.09 * out, -0.2))
        for joint, at, axes in (("knee", knee, shank), ("ankle", ankle, shank)):
            markers[f"{side}_{joint}"] = put(at, axes, (0.0, 0.05 * out, 0.0))
            markers[f"{side}_inner_{joint}"] = put(at, axes, (0.0, -0.05 * out, 0.0))
        markers[f"{side}_heel"] = put(ankle, shank, (-0.06, 0.0, -0.06))
        markers[f"{side}_toe"] = put(ankle, shank, (0.13, 0.0, -0.06))
        shoulder = put(root, chest, (0.0, 0.18 * out, 0.48))
        upper = turned("y", 0.6 * swing)
        lower = turned("y", 0.6 * swing - 0.6 + 0.3 * np.sin(6 * time))
        elbow = shoulder + upper @ (0, 0, -0.3)
        wrist = elbow + lower @ (0, 0, -0.26)
        joints |= {f"{side}_shoulder": shoulder, f"{side}_elbow": elbow, f"{side}_wrist": wrist}
        markers[f"{side}_shoulder"] = put(shoulder, chest, (0.0, 0.0, 0.05))
        markers[f"{side}_elbow"] = put(elbow, upper, (0.0, 0.05 * out, 0.0))
        markers[f"{side}_inner_elbow"] = put(elbow, upper, (0.0, -0.05 * out, 0.0))
        markers[f"{side}_wrist"] = put(wrist, lower, (0.03, 0.0, 0.0))
        markers[f"{side}_outer_wrist"] = put(wrist, lower, (-0.03, 0.0, 0.0))
        markers[f"{side}_front_head"] = put(root, chest, (0.1, 0.06 * out, 0.72))
        markers[f"{side}_back_head"] = put(root, chest, (-0.08, 0.06 * out, 0.72))
    for role, local in (
        ("neck_back", (-0.07, 0.0, 0.53)),
        ("collar", (0.07, 0.0, 0.47)),
        ("breastbone", (0.1, 0.0, 0.3)),
        ("back", (-0.12, 0.0, 0.3)),
    ):
        markers[role] = put(root, chest, local)
    return markers, joints


def made_measures() -> Measures:
    sides = [SideMeasures(np.array([-0.1, 0.09 * out, -0.08]), 0.05, 0.05, 0.05, 0.05, 0.0) for out in SIDES.values()]
    return Measures((sides[0], sides[1]), 0.0, "made")


def made_trial(roles: tuple[str, ...] = (), unit: str = "mm") -> tuple[Trial, MarkerMap]:
    """The made body as a trial, and its map; labels are the roles with their words joined: ``leftknee``."""
    markers = {role: track for role, track in made_body()[0].items() if not roles or role in roles}
    labels = tuple(role.replace("_", "") for role in markers)
    points = np.stack(list(markers.values()), axis=1) * {"mm": 1000.0, "m": 1.0}[unit]
    trial = Trial(
        name="made",
        source="made.c3d",
        labels=labels,
        kinds=("marker",) * len(labels),
        points=points,
        residuals=np.zeros(points.shape[:2]),
        frame_rate=RATE,
        first_frame=1,
        unit=unit,
    )
    return trial, MarkerMap("made", {role: (label,) for role, label in zip(markers, labels, strict=True)})
