"""The 3D view out to a film or to pictures, in the background, by the code that draws for the command line."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np

from studio.app.exporting import partly, words_of
from studio.app.workbench import Workbench
from studio.cli.render import adapted_performers, counted
from studio.core.errors import StudioError
from studio.io.film import write_moving

ADAPTING = 0.05


def film(bench: Workbench, path: Path, size: tuple[int, int], frame_rate: float) -> int:
    """Draw the range of the playhead as the viewport sees it now; returns the task.

    ``size`` is width and height in pixels, ``frame_rate`` pictures a second; a ``path`` that does not end with
    .mp4 becomes a folder of pictures. Raises StudioError without a 3D view.
    """
    from studio.viewport.offscreen import render_video

    if bench.viewport is None:
        raise StudioError("There is no 3D view to film.")
    project, playhead = bench.document.project, bench.document.playhead
    camera, trail = bench.viewport.camera, bench.viewport.trail_point()
    begin, end = playhead.first / playhead.frame_rate, playhead.last / playhead.frame_rate
    times = begin + np.arange(int((end - begin) * frame_rate + 1e-6) + 1) / frame_rate

    def work(progress: Callable[[float, str], None]) -> list[Path]:
        progress(0.0, "Adapting")
        results = adapted_performers(project)
        if not results:
            raise StudioError("No visible character has a motion: there is nothing to film.")

        drawn = partly(progress, ADAPTING, 1.0 - ADAPTING)
        # Closed here, by the thread that drew: whatever stops the film, VTK's window is freed where it was made.
        with closing(render_video(project, results, times.tolist(), size, camera, trail)) as frames:
            write_moving(path, counted(frames, len(times), drawn, path.name), size, frame_rate)
        return [path]

    task: int = bench.runner.run("Film", work, lambda written: bench.said.emit(words_of(written)))
    return task
