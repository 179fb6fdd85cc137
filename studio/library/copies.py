"""Duplicate takes: files with the same motion of the same actor, of which only one is listed."""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable
from pathlib import Path

import numpy as np

from studio.library.catalogue import CatalogueClip, LibraryTake


def distinct_takes(takes: Collection[LibraryTake], clips: Iterable[CatalogueClip]) -> set[int]:
    """Numbers of the takes without duplicates.

    Of equal takes, the one whose file exists is kept; of several, the one with most confirmed labels.
    """
    confirmed = Counter(clip.take for clip in clips if clip.label.confirmed)
    alike = defaultdict(list)
    for take in takes:
        motion = take.motion
        alike[take.actor, motion.frame_rate, motion.channels.shape].append(take)
    kept = set[int]()
    for group in alike.values():
        while group:
            equal = [take for take in group if np.array_equal(take.motion.channels, group[0].motion.channels)]
            group = [take for take in group if take not in equal]
            if len(equal) > 1:  # a disk is asked for copies alone
                equal.sort(key=lambda take: (not Path(take.path).exists(), -confirmed[take.number], take.number))
            kept.add(equal[0].number)
    return kept
