"""Videos and image sequences of the 3D view, rendered by a child process so that the window stays responsive."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.app.exporting import exported_text
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.core.stage.project import Project
from studio.io.atomic_write import new_folder
from studio.io.child_process import child_process, output_lines, wait_for
from studio.io.json_text import JsonObject
from studio.io.media.film import film_encoder, is_film
from studio.viewport.shots import Shots, send_shots

Progress = Callable[[float, str], None]

RENDER_COMMAND = (sys.executable, "-m", "studio.viewport.film_child")

MAX_VIDEO_FRAMES = 1_000_000
"""Maximum number of images: nine hours at 30 fps."""


def render_film(bench: Workbench, path: Path, size: tuple[int, int], frame_rate: float) -> int:
    """Render the play range as seen in the 3D view. Returns the id of the task.

    ``size`` is width and height in pixels, ``frame_rate`` in images per second. A ``path`` that does not end with .mp4
    becomes a folder of images. Raises StudioError without a 3D view, and if the range has too many images.
    """
    if not bench.has_viewport:
        raise StudioError(
            "A video needs the 3D view, which could not be started. Update the driver of the graphics card."
        )
    playhead = bench.document.playhead
    begin, end = playhead.first / playhead.frame_rate, playhead.last / playhead.frame_rate
    count = int((end - begin) * frame_rate + 1e-6) + 1
    if count > MAX_VIDEO_FRAMES:
        raise StudioError(
            f"{count} frames are too many for a video. Set a shorter range; the limit is {MAX_VIDEO_FRAMES}."
        )
    times = begin + np.arange(count) / frame_rate
    shots = Shots(_played(bench.document.project), bench.viewport.view, tuple(times.tolist()), size)

    def work(progress: Progress) -> list[Path]:
        if is_film(path):
            with _renderer(shots) as renderer, film_encoder(path, renderer.stdout, size, frame_rate) as encoder:
                assert renderer.stdout is not None
                renderer.stdout.close()  # an encoder that ends is then noticed by who draws
                _follow(renderer, progress)
                encoder.finish(len(times), lambda: progress(1.0, f"Writing {path.name}"))
        else:
            with new_folder(path) as part, _renderer(replace(shots, stem=part / path.name)) as renderer:
                _follow(renderer, progress)
        return [path]

    task: int = bench.runner.run("Video", work, lambda written: bench.inform(exported_text(written)))
    return task


def _played(project: Project) -> Project:
    """Project without captures and motions that no clip uses."""
    clips = [clip for performer in project.performers.values() for clip in performer.all_clips]
    motions = {clip.motion_id: project.motions[clip.motion_id] for clip in clips if clip.motion_id in project.motions}
    captures = {each.capture_id: project.captures[each.capture_id] for each in motions.values()}
    return replace(project, motions=motions, captures=captures)


@contextmanager
def _renderer(shots: Shots) -> Iterator["subprocess.Popen[bytes]"]:
    """Context with the child process that renders ``shots``."""
    with tempfile.TemporaryFile() as asked:
        send_shots(shots, asked)
        asked.seek(0)
        with child_process(RENDER_COMMAND, asked, subprocess.PIPE, subprocess.PIPE) as renderer:
            yield renderer


def _follow(renderer: "subprocess.Popen[bytes]", progress: Progress) -> None:
    """Report the progress of the child process. Raises StudioError with the child's error, or if the child ends without
    a result.
    """
    share, text, last = 0.0, "Starting", ""
    assert renderer.stderr is not None
    for line in output_lines(renderer.stderr):
        match _record(line or ""):
            case {"error": sentence}:
                raise StudioError(sentence)
            case {"errno": number}:
                raise OSError(number, os.strerror(number))
            case {"share": share, "text": text}:
                pass
            case _:
                last = line or last
        progress(share, text)
    code = wait_for(renderer, lambda: progress(share, text))
    if code:
        reason = f": {last}" if code > 0 and last else ""
        raise StudioError(
            f"The renderer of the video crashed at '{text}'{reason}. Nothing was written. Choose a smaller size"
            " or update the driver of the graphics card."
        )


def _record(line: str) -> JsonObject:
    """JSON record in a line of the child's output; empty if the line is other output."""
    try:
        record = json.loads(line)
    except ValueError:
        return {}
    return record if isinstance(record, dict) else {}
