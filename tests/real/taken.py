"""Captures that tests adapt, loaded and normalised once: the project's recordings, and captures of people."""

import atexit
from functools import cache, lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from examples.keyed.recording import RECORDINGS, write_recording
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.io.importing import load_capture
from tests.captures import CAPTURES, missing

HUMANS = tuple(path for path in sorted((CAPTURES / "bvh").rglob("*.bvh")) if path.stem != "pybvh_rotation_first_root")
WALKS = tuple(path for path in HUMANS if "walk" in path.stem.lower() or "Retreat" in path.stem)
STRIKES = tuple(path for path in HUMANS if path.parent.name == "strikes")
REPRESENTATIVE = (
    "bvhtoolbox_walk01", "cmu_max_jumping_jacks", "fair_dab_zup", "geno_bind_6ch", "pybvh_test1_inch_zup",
    "pybvh_test3_fingers", "accad_male2_G2_FrontKick", "accad_male2_E1_JabLeft", "mass_kick", "mass_backflip",
    "accad_female1_B03_Walk1", "accad_female1_A08_CrouchToLie", "accad_female1_D6_CartWheel",
)  # fmt: skip
"""One of every convention, actor and kind of movement."""

_folder = TemporaryDirectory(prefix="morpho-studio-recordings-")
atexit.register(_folder.cleanup)


@lru_cache(maxsize=len(HUMANS) + len(RECORDINGS))
def taken(path: Path) -> tuple[Capture, NormalizedMotion, SourceRig]:
    capture = load_capture(path)
    return capture, *normalize_capture(capture)


@cache
def named(stem: str) -> Path:
    """A recording or a capture of people; the test is skipped where that is not there."""
    if stem in RECORDINGS:
        write_recording(stem, recorded := Path(_folder.name) / f"{stem}.bvh")
        return recorded
    for path in HUMANS:
        if path.stem == stem:
            return path
    pytest.skip(missing(CAPTURES / "bvh" / f"{stem}.bvh"))


def contacts_of(capture: Capture) -> tuple[ContactInterval, ...]:
    found = capture_contacts(capture)
    return tuple(ContactInterval("motion", point, *span) for point, spans in found.items() for span in spans)
