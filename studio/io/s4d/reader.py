"""Reader of S4D files: bounded, checked member by member, and assembled to the original capture."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.annotations import Annotations, Label
from studio.core.captures.capture import Capture, Guess
from studio.core.errors import StudioError
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import girdle_of, restore_joint_poses
from studio.core.rotations import IDENTITY_QUATERNION, to_matrix
from studio.io.json_text import json_of
from studio.io.npy import array_of
from studio.io.project.constraint_file import constraint_of, contacts_of
from studio.io.project.value_json import Json, MemberCodec, from_json
from studio.io.referenced_files import read_bytes
from studio.io.s4d.writer import (
    CHANNELS_MEMBER,
    RECORD_MEMBER,
    ROTATIONS_MEMBER,
    S4D_FORMAT,
    S4D_VERSION,
    TRANSLATIONS_MEMBER,
    S4d,
)
from studio.io.zipped import UnpacksTooFarError, unzipped_members

FloatArray = NDArray[np.float64]

MOST_S4D_JOINTS = 4096
_SPARE_BYTES = 50_000_000
_SPARE_POSES = 2_500_000
"""Poses of single joints that any file may unfold to; each byte of it allows one more."""
_LARGEST = 1e6


@dataclass(frozen=True)
class _Provenance:
    """Part of the record about the source file."""

    source: str
    unit: str
    up_axis: str
    guesses: tuple[Guess, ...]
    repairs: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Actor:
    """Part of the record about the actor; shapes are checked when the skeleton and rig are made."""

    joints: tuple[str, ...]
    parents: tuple[int, ...]
    end_sites: tuple[int, ...]
    offsets: FloatArray
    reference_rotations: FloatArray
    segment_joints: tuple[int, ...]
    alignments: FloatArray
    origin: FloatArray
    morphology: dict[str, Any]
    rotations_of: tuple[int, ...]
    translations_of: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class _Record:
    """Record of an S4D file."""

    name: str
    frame_rate: float
    first_frame: int
    spine_places: FloatArray
    contacts: Any
    constraints: tuple[Any, ...]
    labels: tuple[Label, ...]
    actor: _Actor
    provenance: _Provenance


def read_s4d(path: Path, motion_id: str = "") -> S4d:
    """Content of the S4D file at ``path``; contacts and constraints get the id ``motion_id``.

    Raises StudioError, which names the file, the member and what to do.
    """
    size, members = _members(path)
    record = _record(members[RECORD_MEMBER], path)
    arrays = {
        name: _array(members[name], name, path) for name in (CHANNELS_MEMBER, ROTATIONS_MEMBER, TRANSLATIONS_MEMBER)
    }
    try:
        frames, joints = len(arrays[CHANNELS_MEMBER]), len(record.actor.joints)
        if joints > MOST_S4D_JOINTS or frames * joints > _SPARE_POSES + size:
            raise ValueError(f"{frames} frames of {joints} joints are more than a file of this size can hold.")
        motion = NormalizedMotion(record.name, record.frame_rate, arrays[CHANNELS_MEMBER], record.spine_places)
        actor = _actor(record.actor, motion, arrays)
        motion = replace(motion, girdle=girdle_of(actor.morphology))
        capture = _capture(record, motion, actor)
    except StudioError as error:
        raise StudioError(f"{path.name}: {error}") from error
    except ValueError as error:
        raise _damaged(path, str(error)) from error
    return S4d(capture, motion, actor, _annotations(record, motion_id, capture.frame_count, path))


def _members(path: Path) -> tuple[int, dict[str, bytes]]:
    """Size of the file, and its four members unpacked, limited together by a multiple of the size."""
    content = read_bytes(path)
    try:
        names = (RECORD_MEMBER, CHANNELS_MEMBER, ROTATIONS_MEMBER, TRANSLATIONS_MEMBER)
        return len(content), unzipped_members(content, 20 * len(content) + _SPARE_BYTES, names)
    except UnpacksTooFarError as error:
        raise StudioError(f"{path.name} {error}, far more than it can hold: it is not a motion. Delete it.") from error
    except ValueError as error:
        raise _damaged(path, f"{error}.") from error


def _damaged(path: Path, reason: str) -> StudioError:
    return StudioError(f"{path.name} is not a complete S4D file: {reason} Copy it again, or write it again.")


def _record(content: bytes, path: Path) -> _Record:
    try:
        parsed = json_of(content, parse_constant=_refuse, parse_float=_finite)
    except ValueError as error:
        raise _damaged(path, f"'{RECORD_MEMBER}' is not readable as JSON ({error}).") from error
    if not isinstance(parsed, dict) or parsed.get("format") != S4D_FORMAT:
        raise _damaged(path, f"'{RECORD_MEMBER}' does not say that it is one.")
    version = parsed.get("version")
    if version != S4D_VERSION:
        raise StudioError(f"{path.name} has version {str(version)[:20]} of S4D. Install a newer Morpho Studio.")
    try:
        found: _Record = from_json(parsed, _Record, MemberCodec(_no_member, _no_member))
    except (ValueError, TypeError, OverflowError, StudioError) as error:
        raise _damaged(path, f"'{RECORD_MEMBER}', {error}") from error
    return found


def _array(content: bytes, name: str, path: Path) -> FloatArray:
    """Numbers of a member as float64, C-ordered; all finite and plausible."""
    try:
        numbers = array_of(content)
    except ValueError as error:
        raise _damaged(path, f"'{name}': {error}.") from error
    if numbers.dtype.str not in ("<f4", "<f8"):
        raise _damaged(path, f"'{name}': its numbers are '{numbers.dtype.str}', not '<f4' or '<f8'.")
    if numbers.ndim > 3:
        raise _damaged(path, f"'{name}': its header does not fit its content.")
    if not (np.abs(numbers) <= _LARGEST).all():  # NaN is not either
        raise _damaged(path, f"'{name}' holds a number that is not finite or out of range.")
    return np.ascontiguousarray(numbers, dtype=np.float64)


def _actor(record: _Actor, motion: NormalizedMotion, arrays: dict[str, FloatArray]) -> SourceRig:
    """Actor of a record. Raises StudioError and ValueError if parts are wrong or do not fit each other."""
    layout, joints, frames = BodyLayout(len(motion.spine_places)), len(record.joints), motion.frame_count
    _indices("end_sites", record.end_sites, joints)
    _indices("rotations_of", record.rotations_of, joints)
    _indices("translations_of", record.translations_of, joints)
    _indices("segment_joints", [joint for joint in record.segment_joints if joint != -1], joints)
    if not frames or not (0.0 < motion.frame_rate < _LARGEST):
        raise ValueError(f"{frames} frames at {motion.frame_rate:g}Hz are not a motion.")
    places = motion.spine_places
    if places.shape != (layout.spine_count,) or places[0] != 0.0 or (np.diff(places) < 0.0).any():
        raise ValueError("spine_places rise from 0.")
    for name, array, shape in (
        ("offsets", record.offsets, (joints, 3)),
        ("reference_rotations", record.reference_rotations, (joints, 4)),
        ("segment_joints", np.array(record.segment_joints), (layout.segment_count,)),
        ("alignments", record.alignments, (layout.segment_count, 4)),
        ("origin", record.origin, (3,)),
        (ROTATIONS_MEMBER, arrays[ROTATIONS_MEMBER], (frames, len(record.rotations_of), 4)),
        (TRANSLATIONS_MEMBER, arrays[TRANSLATIONS_MEMBER], (frames, len(record.translations_of), 3)),
    ):
        if array.shape != shape:
            raise ValueError(f"{name} of shape {shape} expected, not {array.shape}.")
        if not (np.abs(array) <= _LARGEST).all():
            raise ValueError(f"{name}: a number is out of range.")
    if (np.linalg.norm(record.alignments, axis=1) < 0.5).any() or record.segment_joints[0] < 0:
        raise ValueError("alignments and the pelvis' joint must be there.")
    ends = np.zeros(joints, dtype=bool)
    ends[list(record.end_sites)] = True
    skeleton = Skeleton(record.joints, np.array(record.parents), record.offsets, ends)
    body = Morphology.from_json(record.morphology)
    if body.layout != layout or np.abs(body.packed).max() > _LARGEST:
        raise ValueError("the morphology does not fit the channels.")
    rotations = np.tile(IDENTITY_QUATERNION, (frames, joints, 1))
    rotations[:, list(record.rotations_of)] = arrays[ROTATIONS_MEMBER]
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, list(record.translations_of)] = arrays[TRANSLATIONS_MEMBER]
    return SourceRig(
        skeleton,
        body,
        np.array(record.segment_joints),
        to_matrix(record.alignments / np.linalg.norm(record.alignments, axis=1, keepdims=True)),
        record.origin,
        PoseSequence(rotations, translations),
    )


def _capture(record: _Record, motion: NormalizedMotion, actor: SourceRig) -> Capture:
    layout, joints = BodyLayout(len(motion.spine_places)), actor.segment_joints.tolist()
    spine = layout.spine_count
    parts = {
        layout.part_of_segment(segment): joint
        for segment, joint in enumerate(joints)
        if joint >= 0 and segment >= spine
    }
    if (np.linalg.norm(record.actor.reference_rotations, axis=1) < 0.5).any():
        raise ValueError("reference_rotations are quaternions of length 1.")
    return Capture(
        name=motion.name,
        source=record.provenance.source,
        skeleton=actor.skeleton,
        poses=restore_joint_poses(motion, actor),
        frame_rate=motion.frame_rate,
        body_map=BodyMap({BodyPart.PELVIS: joints[0], **parts}, tuple(joints[:spine])),
        reference_rotations=record.actor.reference_rotations,
        floor=float(actor.origin[2]),
        unit=record.provenance.unit,
        up_axis=record.provenance.up_axis,
        first_frame=record.first_frame,
        guesses=record.provenance.guesses,
        repairs=(),
    )


def _annotations(record: _Record, motion_id: str, frames: int, path: Path) -> Annotations:
    where = f"{path.name}, '{RECORD_MEMBER}'"
    constraints = tuple(
        constraint_of(each, motion_id, f"{where}, constraints[{index}]")
        for index, each in enumerate(record.constraints)
    )
    contacts = None if record.contacts is None else contacts_of(record.contacts, motion_id, where)
    last = max([each.last for each in contacts or ()] + [label.last for label in record.labels], default=0)
    if last >= frames:
        raise StudioError(f"{where}: a contact or label ends at frame {last}, after the last, {frames - 1}.")
    return Annotations(contacts, constraints, record.labels).of_motion(motion_id)


def _indices(name: str, indices: tuple[int, ...] | list[int], joints: int) -> None:
    if len(set(indices)) != len(indices) or any(not 0 <= index < joints for index in indices):
        raise ValueError(f"{name} names a joint twice, or one that is not there.")


def _refuse(name: str) -> None:
    raise ValueError(f"{name} is not a number")


def _finite(text: str) -> float:
    number = float(text)
    if not abs(number) <= 1e300:
        raise ValueError(f"{text[:20]} is out of range")
    return number


def _no_member(_name: Json) -> Any:
    raise ValueError("an array is not expected here.")
