"""Writer of S4D, the file of a morphology-independent motion; ``docs/s4d.md`` describes every field.

A ZIP of one JSON record and of arrays as ``.npy``, which ``zipfile`` and ``numpy`` can read.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import __version__
from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import CONTACT_POINTS, ContactInterval
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import from_matrix
from studio.io.project.constraint_file import constraint_record
from studio.io.registry import Progress
from studio.io.zipped import npy_file, write_zip

FloatArray = NDArray[np.float64]

S4D_FORMAT, S4D_VERSION = "S4D", 1
RECORD_MEMBER, CHANNELS_MEMBER, ROTATIONS_MEMBER, TRANSLATIONS_MEMBER = (
    "s4d.json",
    "channels.npy",
    "rotations.npy",
    "translations.npy",
)

NUMBER_STEP = 2.0**-17
"""Quantum of stored numbers: 8 micrometres, or 0.0004 degrees, so that float32 numbers compress well."""
_UNROUNDED = slice(channel.LIMB_SLACK, channel.LIMB_OFF_PLANE + 4)
"""Columns of channels whose square root determines elbow and knee of a straight limb: stored as unrounded float32."""
_STILL = 1e-9


@dataclass(frozen=True, eq=False)
class S4d:
    """Content of an S4D file; ``motion`` and ``actor`` are those of ``capture``."""

    capture: Capture
    motion: NormalizedMotion
    actor: SourceRig
    annotations: Annotations = Annotations()


def write_s4d(path: Path, s4d: S4d, progress: Progress = lambda share, text: None) -> None:
    """Write an S4D file, whole or not at all: float32, within 0.1 mm and 0.01 degrees of ``s4d.capture`` when read
    back.

    Raises StudioError if it cannot be written; ``progress`` may raise an exception to cancel.
    """
    progress(0.0, f"Writing {path.name}")
    free, moving = pass_through_joints(s4d.actor)
    poses = s4d.actor.pass_through
    members = {
        RECORD_MEMBER: json.dumps(_record(s4d, free, moving), ensure_ascii=False, allow_nan=False).encode(),
        CHANNELS_MEMBER: npy_file(_channels(s4d.motion.channels)),
        ROTATIONS_MEMBER: npy_file(_on_grid(poses.local_rotations[:, free])),
        TRANSLATIONS_MEMBER: npy_file(_on_grid(poses.local_translations[:, moving])),
    }
    write_zip(path, members, 9, progress)
    progress(1.0, f"Wrote {path.name}")


def pass_through_joints(actor: SourceRig) -> tuple[list[int], list[int]]:
    """Joints whose local rotation, and joints whose local translation, is in no channel and no offset."""
    poses, skeleton = actor.pass_through, actor.skeleton
    turned = np.asarray((np.abs(poses.local_rotations[..., :3]) > _STILL).any(axis=(0, 2)))
    turned[actor.segment_joints[actor.segment_joints >= 0]] = False
    moved = np.asarray((np.abs(poses.local_translations - skeleton.offsets) > _STILL).any(axis=(0, 2)))
    moved[actor.segment_joints[0]] = False
    return np.flatnonzero(turned).tolist(), np.flatnonzero(moved).tolist()


def _record(s4d: S4d, free: list[int], moving: list[int]) -> dict[str, Any]:
    capture, actor, notes = s4d.capture, s4d.actor, s4d.annotations
    return {
        "format": S4D_FORMAT,
        "version": S4D_VERSION,
        "name": s4d.motion.name,
        "frame_rate": s4d.motion.frame_rate,
        "first_frame": capture.first_frame,
        "spine_places": _numbers(s4d.motion.spine_places),
        "contacts": None if notes.contacts is None else _by_foot(notes.contacts),
        "constraints": [constraint_record(each) for each in notes.constraints],
        "labels": [{"name": each.name, "first": each.first, "last": each.last} for each in notes.labels],
        "actor": {
            "joints": list(capture.skeleton.names),
            "parents": capture.skeleton.parents.tolist(),
            "end_sites": np.flatnonzero(capture.skeleton.end_sites).tolist(),
            "offsets": _numbers(capture.skeleton.offsets),
            "reference_rotations": _numbers(capture.reference_rotations),
            "segment_joints": actor.segment_joints.tolist(),
            "alignments": _numbers(from_matrix(actor.alignments)),
            "origin": _numbers(actor.origin),
            "morphology": {name: _numbers(np.array(measure)) for name, measure in actor.morphology.to_json().items()},
            "rotations_of": free,
            "translations_of": moving,
        },
        "provenance": {
            "source": capture.source,
            "unit": capture.unit,
            "up_axis": capture.up_axis,
            "guesses": [asdict(guess) for guess in capture.guesses],
            "repairs": list(capture.repairs),
            "program": f"Morpho Studio {__version__}",
        },
    }


def _by_foot(contacts: tuple[ContactInterval, ...]) -> Mapping[str, list[list[int]]]:
    return {
        point.value: [[each.first, each.last] for each in contacts if each.point is point] for point in CONTACT_POINTS
    }


def _numbers(array: FloatArray) -> Any:
    """Nested lists with nine digits, which distinguish any two float32 numbers."""
    rounded = np.vectorize(lambda number: float(f"{number:.9g}"), otypes=[float])(array) if array.size else array
    return (rounded + 0.0).tolist()  # no "-0"


def _channels(channels: FloatArray) -> NDArray[np.float32]:
    stored = _on_grid(channels)
    stored[:, _UNROUNDED] = channels[:, _UNROUNDED]
    return stored


def _on_grid(values: FloatArray) -> NDArray[np.float32]:
    """Float32 values with the frames of one number side by side, the order that compresses best."""
    return np.asfortranarray(np.round(values / NUMBER_STEP) * NUMBER_STEP + 0.0, dtype="<f4")
