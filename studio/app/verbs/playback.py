"""Actions of time: play, step, jump, play range, playback speed."""

from studio.app.workbench import Workbench
from studio.core.solver.performers.rows import stage_span

MAX_PLAYBACK_SPEED = 8.0


def toggle(bench: Workbench) -> None:
    """Play or pause."""
    bench.document.playhead.toggle()


def next_frame(bench: Workbench) -> None:
    """Go to the next frame."""
    bench.document.playhead.step(1)


def previous_frame(bench: Workbench) -> None:
    """Go to the previous frame."""
    bench.document.playhead.step(-1)


def first_frame(bench: Workbench) -> None:
    """Go to the start of the range."""
    bench.document.playhead.set_frame(bench.document.playhead.first)


def last_frame(bench: Workbench) -> None:
    """Go to the end of the range."""
    bench.document.playhead.set_frame(bench.document.playhead.last)


def next_event(bench: Workbench) -> None:
    """Go to the next contact or constraint key."""
    bench.timeline.go_to_key(1)


def previous_event(bench: Workbench) -> None:
    """Go to the previous contact or constraint key."""
    bench.timeline.go_to_key(-1)


def next_problem(bench: Workbench) -> None:
    """Go to the next problem, the worst first."""
    bench.window.problem_tour.go(1)


def previous_problem(bench: Workbench) -> None:
    """Go to the previous problem."""
    bench.window.problem_tour.go(-1)


def add_label(bench: Workbench) -> None:
    """Add a label at the playhead."""
    bench.timeline.add_label()


def next_label(bench: Workbench) -> None:
    """Go to the next label."""
    bench.timeline.go_to_label(1)


def previous_label(bench: Workbench) -> None:
    """Go to the previous label."""
    bench.timeline.go_to_label(-1)


def range_from_here(bench: Workbench) -> None:
    """Set the start of the play range to the playhead."""
    playhead = bench.document.playhead
    playhead.set_range(playhead.frame, max(playhead.last, playhead.frame))


def range_to_here(bench: Workbench) -> None:
    """Set the end of the play range to the playhead."""
    playhead = bench.document.playhead
    playhead.set_range(min(playhead.first, playhead.frame), playhead.frame)


def whole_range(bench: Workbench) -> None:
    """Set the play range to the whole stage."""
    span = stage_span(bench.document.project)
    if span is not None:
        bench.document.playhead.set_range(span.first, span.last)


def shuttle_back(bench: Workbench) -> None:
    """Play backwards; each further call doubles the speed."""
    _shuttle(bench, -1.0)


def shuttle_forward(bench: Workbench) -> None:
    """Play forwards; each further call doubles the speed."""
    _shuttle(bench, 1.0)


def stop(bench: Workbench) -> None:
    """Pause, and reset the speed to real time."""
    bench.document.playhead.pause()
    bench.document.playhead.speed = 1.0


def toggle_loop(bench: Workbench) -> None:
    """Toggle looping of playback over the range."""
    bench.document.playhead.loop = not bench.document.playhead.loop


def _shuttle(bench: Workbench, direction: float) -> None:
    playhead = bench.document.playhead
    along = playhead.playing and playhead.speed * direction > 0
    playhead.speed = max(min(2.0 * playhead.speed, MAX_PLAYBACK_SPEED), -MAX_PLAYBACK_SPEED) if along else direction
    playhead.play()
