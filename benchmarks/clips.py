"""Captures that are measured on: real ones in MORPHO_CAPTURES or beside the checkout, bundled ones elsewhere."""

import os
from pathlib import Path

from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import ReadyCapture, ready_capture
from studio.resources_folder import example_captures_folder

ROOT = Path(__file__).resolve().parents[1]
REAL = Path(os.environ.get("MORPHO_CAPTURES") or ROOT.parent / "shared" / "captures") / "bvh"
CHOSEN = (
    "varied/accad_female1_D3_ConversationGestures.bvh",
    "varied/accad_male2_A6_BoxLift.bvh",
    "varied/accad_female1_B03_Walk1.bvh",
    "strikes/accad_male2_E1_JabLeft.bvh",
    "strikes/accad_male2_G2_FrontKick.bvh",
)
"""Gestures at 30 Hz, a box lifted at 120 Hz, a walk, and a punch and a kick as in the papers."""
BUNDLED = ("reach_grasp.bvh", "walk_turn.bvh", "straight_punch.bvh", "front_kick.bvh")


def load_clips() -> dict[str, ReadyCapture]:
    """The clips by name."""
    folder, names = (REAL, CHOSEN) if REAL.is_dir() else (example_captures_folder(), BUNDLED)
    return {Path(name).stem: ready_capture(folder / name, GUESS_ALL) for name in names}
