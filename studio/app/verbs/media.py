"""Actions of sound tracks and reference footage."""

from pathlib import Path

from studio.app.file_dialogs import MEDIA_FILTERS, ask_file
from studio.app.workbench import Workbench
from studio.core.stage.footage import Footage
from studio.core.stage.sound_track import SoundTrack
from studio.io.media.footage_file import read_footage
from studio.io.media.sound_file import read_sound
from studio.panels.message_strip import Lifetime


def ask_sound(bench: Workbench) -> None:
    """Ask for a sound file, or for a video with sound."""
    ask_file(bench, "Add sound", MEDIA_FILTERS["sounds"], lambda path: add_sound(bench, path))


def add_sound(bench: Workbench, path: Path) -> None:
    """Read a sound in the background, then add it to the timeline; one undo step."""

    def done(sound: SoundTrack) -> None:
        sound_id = bench.document.add("sounds", sound, f"Add {sound.name}")
        bench.document.selection.set(("sounds", sound_id))
        bench.inform(
            f"{path.name}: {len(sound.beats)} beats found. Keys and contacts snap to them.", until=Lifetime.EDITED
        )

    bench.runner.run(f"Reading {path.name}", lambda progress: read_sound(path, lambda: progress(0.0, path.name)), done)


def toggle_muted(bench: Workbench) -> None:
    """Mute or unmute sounds."""
    playback = bench.window.sound_playback
    playback.set_muted(not playback.muted)


def ask_footage(bench: Workbench) -> None:
    """Ask for a video, or for one image of a numbered sequence."""
    ask_file(bench, "Add footage", MEDIA_FILTERS["footage"], lambda path: add_footage(bench, path))


def add_footage(bench: Workbench, path: Path) -> None:
    """Count the frames of a video or image sequence in the background, then add it to the timeline and show it; one
    undo step.
    """

    def done(footage: Footage) -> None:
        footage_id = bench.document.add("footage", footage, f"Add {footage.name}")
        bench.document.selection.set(("footage", footage_id))
        bench.window.show_dock("Footage")
        bench.inform(
            f"{path.name}: {footage.frames} frames at {footage.frame_rate:g} fps. Set start and frame rate in"
            " the inspector.",
            until=Lifetime.EDITED,
        )

    bench.runner.run(f"Reading {path.name}", lambda _: read_footage(path), done)
