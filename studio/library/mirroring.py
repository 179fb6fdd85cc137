"""Library of twice the size, with a mirror image of each clip for the other limb."""

from dataclasses import replace

from studio.core.normalized.mirror import mirrored_contacts, mirrored_motion
from studio.core.normalized.realize import realize_motion
from studio.library.clip_labels import Limb
from studio.library.hit_paths import hit_path
from studio.library.library import Library, LibraryClip


def with_mirrored(library: Library) -> Library:
    """Library with the mirror image of each clip added, in memory; its number is minus that of the original."""
    return Library.of_clips([*library.clips, *(_mirrored(clip) for clip in library.clips)])


def _mirrored(clip: LibraryClip) -> LibraryClip:
    take = clip.take
    motion = mirrored_motion(take.motion)
    turned = replace(take, number=-take.number, motion=motion, contacts=mirrored_contacts(take.contacts))
    label = replace(clip.label, limb=Limb(clip.label.limb ^ 1))
    path = hit_path(*realize_motion(motion, clip.actor.body), clip.actor.body, motion.frame_rate, label)
    return LibraryClip(-clip.number, label, path, turned, clip.actor)
