"""Actions of sound tracks."""

from pathlib import Path

from studio.app.file_dialogs import ask_file
from studio.app.workbench import Workbench
from studio.core.stage.sound_track import SoundTrack
from studio.io.media.sound_file import SOUND_SUFFIXES, read_sound
from studio.panels.message_strip import Lifetime


def ask_sound(bench: Workbench) -> None:
    """Ask for a sound, or a film whose sound is meant."""
    kinds = f"Sounds and films ({' '.join(f'*{suffix}' for suffix in SOUND_SUFFIXES)})"
    ask_file(bench, "Add sound", kinds, lambda path: add_sound(bench, path))


def add_sound(bench: Workbench, path: Path) -> None:
    """Read a sound in the background, then put it on the timeline from its begin on; one undo step."""

    def done(sound: SoundTrack) -> None:
        sound_id = bench.document.add("sounds", sound, f"Add {sound.name}")
        bench.document.selection.set(("sounds", sound_id))
        bench.say(
            f"{path.name}: {len(sound.beats)} beats found. Keys and contacts snap to them.", until=Lifetime.EDITED
        )

    bench.runner.run(f"Reading {path.name}", lambda progress: read_sound(path, lambda: progress(0.0, path.name)), done)
