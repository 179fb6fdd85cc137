"""Library in memory: actors, clips and the table that is searched, as immutable values that threads may share."""

import json
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.clip_search import SearchTable, pose_rows
from studio.core.errors import StudioError
from studio.core.kernels import pose_search as at
from studio.core.normalized.realize import realize_motion
from studio.io.atomic_write import write_atomically
from studio.io.npy import stored_array, write_stored
from studio.io.referenced_files import read_bytes
from studio.library.catalogue import Actor, Catalogue, CatalogueClip, LibraryTake
from studio.library.clip_labels import ClipLabel, Kind
from studio.library.copies import distinct_takes
from studio.library.hit_paths import HitPath

FloatArray = NDArray[np.float64]

LEAST_SWING_SECONDS = 0.2
"""Least time in seconds from the start of a strike to its hit; a strike with less time to swing would look abrupt."""
POSES_FILE, POSES_STAMP_FILE = "poses.npy", "poses.json"
"""Name of the file of the table of poses, and of the file that lists the clips and frames of this table."""


@dataclass(frozen=True, eq=False)
class LibraryClip:
    """Clip of the library with its label, hit path, take and actor."""

    number: int
    label: ClipLabel
    path: HitPath
    take: LibraryTake
    actor: Actor

    @property
    def name(self) -> str:
        """Name such as ``straight_punch: right arm punch``."""
        return f"{self.take.motion.name}: {self.label.limb.words} {self.label.kind}"

    @property
    def searched_frames(self) -> range:
        """Frames of the take from which a strike may start, so that it has ``LEAST_SWING_SECONDS`` to swing."""
        swung = self.path.first - round(LEAST_SWING_SECONDS * self.take.motion.frame_rate)
        return range(self.label.first, max(swung, self.label.first + 1))


@dataclass(frozen=True, eq=False)
class Library:
    """All clips that can be searched; ``actors`` and ``clips`` are in the order of the indices in ``table``."""

    actors: tuple[Actor, ...]
    clips: tuple[LibraryClip, ...]
    table: SearchTable

    @classmethod
    def of(cls, catalogue: Catalogue) -> "Library":
        """Library of a catalogue, without duplicate takes. Its poses stay on disk, and are recomputed if clips have
        changed.
        """
        with catalogue.read_transaction():
            takes, actors, known = catalogue.takes(), catalogue.actors(), catalogue.clips()
        kept = distinct_takes(takes.values(), known)
        strikes = [
            clip
            for clip in known
            if clip.label.kind is not Kind.NONE and clip.take in kept and clip.is_within(takes[clip.take])
        ]
        clips = [_with_take(clip, takes[clip.take], actors) for clip in strikes]
        return cls.of_clips(clips, _stored_poses(catalogue, clips))

    @classmethod
    def of_clips(cls, clips: list[LibraryClip], poses: NDArray[np.float32] | None = None) -> "Library":
        """Library of ``clips``; without ``poses`` (F, 64) the pose rows are computed in memory."""
        actors = tuple({clip.actor.number: clip.actor for clip in clips}.values())
        places = {actor.number: index for index, actor in enumerate(actors)}
        paths = [clip.path.places for clip in clips]
        table = SearchTable(
            rows=_poses_of(clips) if poses is None else poses,
            frame_counts=np.array([len(clip.searched_frames) for clip in clips], dtype=np.int64),
            paths=np.concatenate([np.empty((0, 3)), *paths]),
            path_counts=np.array([len(path) for path in paths], dtype=np.int64),
            actors=np.array([places[clip.actor.number] for clip in clips], dtype=np.int64),
            limbs=np.array([int(clip.label.limb) for clip in clips], dtype=np.int64),
        )
        return cls(actors, tuple(clips), table)

    def place_of(self, row: int) -> tuple[LibraryClip, int]:
        """Clip, and frame of its take, of the pose in ``row`` of the table."""
        number = int(np.searchsorted(self.table.first_rows, row, "right")) - 1
        clip = self.clips[number]
        return clip, clip.searched_frames.start + row - int(self.table.first_rows[number])

    @cached_property
    def frame_count(self) -> int:
        """Number of frames in the table."""
        return len(self.table.rows)


def _with_take(clip: CatalogueClip, take: LibraryTake, actors: dict[int, Actor]) -> LibraryClip:
    return LibraryClip(clip.number, clip.label, clip.path, take, actors[take.actor])


def _poses_of(clips: list[LibraryClip]) -> NDArray[np.float32]:
    """Pose rows (F, 64) of the searched frames of all clips; each take is posed once."""
    rows = [np.empty((0, at.POSE_WIDTH), dtype=np.float32)]
    posed: tuple[int, FloatArray] | None = None
    for clip in clips:
        body = clip.actor.body
        if posed is None or posed[0] != clip.take.number:
            posed = clip.take.number, realize_motion(clip.take.motion, body)[0]
        rows.append(pose_rows(posed[1][clip.searched_frames.start : clip.searched_frames.stop], body.layout))
    return np.concatenate(rows)


def _stored_poses(catalogue: Catalogue, clips: list[LibraryClip]) -> NDArray[np.float32]:
    """Pose rows (F, 64) of all clips, read from disk; recomputed if the stored rows are damaged or of other clips."""
    folder = catalogue.folder
    poses, said = folder / POSES_FILE, folder / POSES_STAMP_FILE
    stamp = json.dumps(
        [
            [each.number, each.take.number, each.take.checksum, each.searched_frames.start, each.searched_frames.stop]
            for each in clips
        ]
    )
    count = sum(len(clip.searched_frames) for clip in clips)
    with suppress(OSError, ValueError, StudioError):
        stored = stored_array(poses) if read_bytes(said) == stamp.encode() else None
        if (
            stored
            and stored.values.dtype == np.float32
            and stored.values.shape == (count, at.POSE_WIDTH)
            and stored.is_whole()
        ):
            return stored.values
    computed = _poses_of(clips)
    if not catalogue.read_only:
        try:
            said.unlink(missing_ok=True)
            write_stored(poses, computed)
            write_atomically(said, stamp.encode())
            return np.asarray(stored_array(poses).values)
        except (OSError, ValueError, StudioError) as error:
            catalogue.add_remark(f"The poses of the library are computed at each start. {error}")
    return computed
