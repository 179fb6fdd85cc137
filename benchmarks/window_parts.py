"""Computing time of each part of the window: processor time of its thread, of its workers, and of the rest."""

import threading
import time
from collections import defaultdict
from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Any

from studio.document.document import Document
from studio.engine.live_adaptation import LiveAdaptation
from studio.panels.inspector import Inspector
from studio.timeline.track_view import TrackView
from studio.viewport.bodies import BodyVisual
from studio.viewport.canvas import Canvas
from studio.viewport.floor import SoftShadows
from studio.viewport.live_mesh import LiveLines
from studio.viewport.stage_picture import StageScene
from studio.viewport.widget import Viewport

MEASURED: tuple[tuple[str, type, str], ...] = (
    ("engine", LiveAdaptation, "_refresh"), ("engine", LiveAdaptation, "_take"),
    ("solving for the picture", LiveAdaptation, "solve_frame"), ("painting of all that has changed", Canvas, "_take"),
    ("drawing: bodies", BodyVisual, "pose"), ("drawing: shadows", SoftShadows, "cast"),
    ("drawing: lines", Viewport, "_paths"), ("drawing: lines", LiveLines, "show_paths"),
    ("drawing: VTK and its copy", StageScene, "render"), ("drawing: other", Canvas, "_draw"),
    ("painting the view", Canvas, "paintEvent"), ("problem's chip", Viewport, "_tell_problem"),
    ("document", Document, "replace"),
    ("timeline", TrackView, "paintEvent"), ("timeline", TrackView, "lay_out"),
    ("inspector", Inspector, "_entity_changed"), ("inspector", Inspector, "_refresh"),
)  # fmt: skip
"""Part, class and method; what one calls that is measured by itself is not counted with it."""


BESIDE = {"solve-": "solving beside", "journal": "keeping the journal"}
"""Tasks of other threads, by how their names begin."""


class Parts:
    """Processor seconds by part while it is ``on``."""

    def __init__(self) -> None:
        """Before there is a window, whose signals know its methods."""
        self.seconds: dict[str, float] = defaultdict(float)
        self.on = False
        self._inner = [0.0]
        for name, owner, method in MEASURED:
            setattr(owner, method, self._measured(name, getattr(owner, method)))

    def begin(self) -> None:
        """Count from now on."""
        self.seconds.clear()
        self._begun = self._threads()
        self.on = True

    def end(self) -> dict[str, float]:
        """Processor seconds by part since ``begin``, with all that is left over of each thread."""
        self.on = False
        now = self._threads()
        spent = {name: now[name] - self._begun.get(name, 0.0) for name in now}
        parts, total, window = dict(self.seconds), spent.pop("all"), spent.pop("window")
        parts["window's thread, other"] = window - sum(parts.values())
        parts |= spent
        parts["drawing threads of software GL"] = total - window - sum(spent.values())
        return parts | {"all": total}

    def _threads(self) -> dict[str, float]:
        """Processor seconds of the process, of the window's thread, and of others by what they do."""
        seconds = {"all": time.process_time(), "window": time.thread_time()}
        for thread in threading.enumerate():
            for begin, what in BESIDE.items():
                if thread.name.startswith(begin) and thread.ident is not None:
                    clock = time.pthread_getcpuclockid(thread.ident)
                    seconds[what] = seconds.get(what, 0.0) + time.clock_gettime(clock)
        return seconds

    def _measured(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        # Qt gives a slot that takes any arguments all that a signal says.
        taken = signature(function).parameters.values()
        most = None if any(each.kind is Parameter.VAR_POSITIONAL for each in taken) else len(taken)

        @wraps(function)
        def run(*every: Any, **named: Any) -> Any:
            arguments = every[:most]
            if not self.on:
                return function(*arguments, **named)
            begun = time.thread_time()
            self._inner.append(0.0)
            try:
                return function(*arguments, **named)
            finally:
                spent = time.thread_time() - begun
                self.seconds[name] += spent - self._inner.pop()
                self._inner[-1] += spent

        return run
