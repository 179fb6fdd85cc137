"""``render``: draw a project, or a capture on characters, as a picture or a film."""

from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import entry_points
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.cli.import_arguments import import_options
from studio.cli.outputs import refuse_replacing
from studio.cli.printing import print_json
from studio.core.errors import StudioError
from studio.core.names import counted_noun
from studio.core.stage.project import Project
from studio.core.stage.saved_camera import CameraPlacement
from studio.core.stage.staging import project_of_capture
from studio.io.media.film import write_moving
from studio.io.png import write_png
from studio.jobs.adaptation import ADAPTED_MOTION_ID, chosen_characters, make_folder, ready_capture
from studio.jobs.bundled_scenes import is_project, open_project
from studio.jobs.performances import stage_duration, stage_performances
from studio.startup.kernel_warm_up import compile_first
from studio.startup.process import check_libraries
from studio.startup.progress import Progress, progress_line

Pixels = NDArray[np.uint8]


def run(arguments: Namespace) -> int:
    """Stage, adapt and draw, and return the exit code."""
    suffix = arguments.out.suffix.lower()
    if suffix not in (".png", ".mp4", ""):
        sentence = "has no image format. Use .png or .mp4, or a new folder for an image sequence."
        raise StudioError(f"{arguments.out.name} {sentence}")
    if arguments.time is not None and suffix != ".png":
        raise StudioError("--time selects a still image: use a .png file.")
    if suffix:
        refuse_replacing([arguments.out], arguments.source, arguments.overwrite)
    check_libraries()
    compile_first()
    project = staged_project(arguments)
    placement = placement_of(project, arguments)
    made = stage_performances(project)
    results = {key: each.adapted for key, each in made.performances.items()}
    failed = [f"{project.performers[key].name}: {reason}" for key, reason in made.failures.items()]
    if failed and not results:
        raise StudioError(f"No character could be adapted. {failed[0]}")
    if not results:
        raise StudioError(f"{arguments.source.name} has no visible character with a clip: there is nothing to render.")
    duration = max(stage_duration(project, key) for key in results)
    if arguments.time is not None and not 0.0 <= arguments.time <= duration + 1e-9:
        raise StudioError(
            f"--time {arguments.time:g} is outside {arguments.source.name}, which lasts {duration:.2f} seconds."
        )
    make_folder(arguments.out.parent)
    if suffix == ".png":
        time = duration / 2 if arguments.time is None else arguments.time
        times = [time]
        write_png(arguments.out, renderer("picture")(project, results, time, arguments.size, placement))
    else:
        times = [frame / arguments.film_rate for frame in range(int(duration * arguments.film_rate) + 1)]
        frames = renderer("film")(project, results, times, arguments.size, placement)
        told = with_progress(frames, len(times), progress_line(), arguments.out.name)
        write_moving(arguments.out, told, arguments.size, arguments.film_rate)
    return _say(arguments, len(times), len(results), failed)


def staged_project(arguments: Namespace) -> Project:
    """Project to draw: that of the file, or a capture on the chosen characters side by side."""
    if is_project(arguments.source):
        if arguments.character:
            raise StudioError("--character can only be used with a capture.")
        return open_project(arguments.source)
    characters = chosen_characters(arguments.character)
    ready = ready_capture(arguments.source, import_options(arguments))
    return project_of_capture(ready.capture, ready.contacts, characters, ADAPTED_MOTION_ID)


def placement_of(project: Project, arguments: Namespace) -> CameraPlacement | None:
    """Placement of the saved camera that ``--camera`` names; None without it. Raises StudioError for an unknown one."""
    if arguments.camera is None:
        return None
    found = {each.name: each.placement for each in project.cameras.values()}
    if arguments.camera not in found:
        known = f"It has {', '.join(found)}." if found else "It has none: save one by View > Add camera."
        raise StudioError(f"{arguments.source.name} has no camera '{arguments.camera}'. {known}")
    return found[arguments.camera]


def renderer(kind: str) -> Callable[..., Any]:
    """Function that draws a ``picture`` or a ``film``, found by its entry point, so that this module imports no
    toolkit.
    """
    found = entry_points(group="morpho_studio.render", name=kind)
    if not found:
        raise StudioError("The renderer is not installed. Install Morpho Studio with `pip install -e .`.")
    drawing: Callable[..., Any] = next(iter(found)).load()
    return drawing


def with_progress(frames: Iterator[Pixels], count: int, progress: Progress, name: str) -> Iterator[Pixels]:
    """The ``frames`` unchanged; progress is reported after each."""
    for done, frame in enumerate(frames, 1):
        yield frame
        progress(done / count, name)


def _say(arguments: Namespace, frames: int, characters: int, failed: Sequence[str]) -> int:
    record = {"ok": True, "source": str(arguments.source), "file": str(arguments.out), "size": list(arguments.size)}
    if arguments.json:
        print_json({**record, "frames": frames, "characters": characters, "failed": failed})
    else:
        size = f"{arguments.size[0]}x{arguments.size[1]}"
        print(f"{arguments.out}: {counted_noun(frames, 'image')} of {size}, {counted_noun(characters, 'character')}.")
        for sentence in failed:
            print(f"Not adapted: {sentence}")
    return 0
