"""Surfaces that a soak tries by seeds instead of spoilt files: a catalogue, a recording, a stage, command lines, kills,
actions of the window, projects opened and closed.

Each trial raises where something is lost or goes wrong.
"""

import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

from studio.core.errors import StudioError
from studio.live.osc import LARGEST_PACKET
from studio.live.recording import read_recording, write_recording
from tests.cli import odd_words
from tests.document.killed import CHECKS
from tests.gui import opened_projects, random_actions
from tests.io import spoilt_stages
from tests.io.test_fuzz import bytes_changed
from tests.library.damaged_catalogue import damage, make_catalogue, use
from tests.live import clip_commands, hostile_bones, short_clips

Trial = Callable[[int, Path], object]


def try_catalogue(seed: int, folder: Path) -> None:
    """Damage a catalogue of two captures and use it; its confirmed label outlasts that."""
    made = folder / "made"
    if not made.exists():
        _labels[folder] = make_catalogue(made)
        shutil.copytree(made / "catalogue", folder / "whole")
    shutil.rmtree(made / "catalogue")
    shutil.copytree(folder / "whole", made / "catalogue")
    how = damage(Random(seed), made / "catalogue")
    try:
        use(made, _labels[folder])
    except AssertionError as error:
        raise AssertionError(f"{how}: {error}") from error


def try_recording(seed: int, folder: Path) -> None:
    """Spoil a recording and read it: what is read is whole, what is not is told."""
    random, path = Random(seed), folder / "session.osc"
    packets = [(0.1 * k, random.randbytes(random.choice([0, 4, 60, 1500]))) for k in range(20)]
    write_recording(path, packets)
    path.write_bytes(bytes_changed(random, path.read_bytes()))
    try:
        recording = read_recording(path)
    except StudioError:
        return
    assert all(seconds >= 0.0 and len(packet) <= LARGEST_PACKET for seconds, packet in recording)
    assert recording.problem or len(recording.packets) >= 1 or path.stat().st_size == 8


def try_kill(seed: int, folder: Path) -> None:
    """Kill a child that edits, saves, exports, records or indexes; nothing that was whole is lost."""
    what, own = sorted(CHECKS)[seed % len(CHECKS)], folder / f"killed {seed}"
    own.mkdir()
    assert CHECKS[what](own, 1, Random(seed)) == 0, f"{what} lost something"
    shutil.rmtree(own)


_labels = {}

SURFACES: dict[str, Trial] = {
    "catalogue": try_catalogue,
    "recording": try_recording,
    "bones": lambda seed, _folder: hostile_bones.play(seed),
    "clips": lambda seed, _folder: short_clips.play(seed, live=seed % 8 == 0),
    "stages": spoilt_stages.play,
    "words": odd_words.play,
    "kills": try_kill,
    "actions": random_actions.play,
    "projects": opened_projects.play,
    "commands": lambda seed, _folder: clip_commands.play(seed, live=seed % 8 == 0),
}
