"""A body found anew from its markers, in the background; it takes the capture's place as one undo step."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from studio.app import importing
from studio.app.workbench import Workbench
from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.markers.take import MarkerTake
from studio.io.importing import ImportOptions


def read_again(bench: Workbench, capture_id: str, option: dict[str, Any]) -> None:
    """Read a capture as the user says; one with markers needs no file for it. Raises StudioError without the file."""
    take = bench.document.project.captures[capture_id].markers
    if take is None:
        importing.reimport(bench, capture_id, option)
    else:
        solve_again(bench, capture_id, take, ImportOptions(**importing.overruled(bench, capture_id) | option))


def solve_again(bench: Workbench, capture_id: str, take: MarkerTake, options: ImportOptions | None = None) -> int:
    """Solve ``take`` as the capture was read, or with other options; returns the task."""
    capture = bench.document.project.captures[capture_id]
    text = f"Solve {capture.name} anew"
    chosen = options or ImportOptions(**importing.overruled(bench, capture_id))
    chosen = replace(chosen, body_map=None, marker_map=None)

    def work(progress: Callable[[float, str], None]) -> tuple[Capture, Annotations]:
        from studio.core.normalized.normalize import detected_contacts  # late: both load kernels
        from studio.io.markers.capture import capture_of_take

        solved = capture_of_take(
            take, chosen, capture.repairs, lambda share, text: progress(importing.READ_SHARE * share, text)
        )
        progress(importing.READ_SHARE, "looking for contacts")
        contacts = detected_contacts(solved, "") if solved.body_map else ()
        return solved, Annotations(contacts)

    def done(answer: tuple[Capture, Annotations]) -> None:
        if capture_id in bench.document.project.captures:
            importing.replace_motion(bench.document, capture_id, *answer, text)

    task: int = bench.runner.run(text, work, done)
    return task
