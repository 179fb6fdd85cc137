"""Log file of warnings and errors, and messages about uncaught exceptions."""

import logging
import sys
import threading
from collections.abc import Callable
from logging.handlers import RotatingFileHandler
from pathlib import Path
from types import TracebackType

import platformdirs
from PySide6.QtCore import QObject, Signal

from studio.core.errors import INTERNAL_ERROR, StudioError

MAX_LOG_BYTES = 1_000_000
_log = logging.getLogger("studio")


def log_file() -> Path:
    """Log file of internal errors."""
    return Path(platformdirs.user_log_dir("morpho-studio", appauthor=False)) / "studio.log"


def start_log() -> None:
    """Log warnings and errors to the log file and to standard error."""
    file = log_file()
    file.parent.mkdir(parents=True, exist_ok=True)
    handlers: list[logging.Handler] = [
        RotatingFileHandler(file, maxBytes=MAX_LOG_BYTES, backupCount=2, encoding="utf-8")
    ]
    if sys.stderr is not None:
        handlers.append(logging.StreamHandler())
    logging.basicConfig(
        level=logging.WARNING, format="%(asctime)s %(name)s %(levelname)s %(message)s", handlers=handlers
    )


def error_sentence(error: BaseException) -> str:
    """Error as a sentence for the user: a StudioError unchanged, any other exception as an internal error with
    advice.
    """
    if isinstance(error, StudioError):
        return str(error)
    what = f"{type(error).__name__}: {error}".rstrip(": ")
    return f"An {INTERNAL_ERROR} occurred: {what}. Your work is backed up; the details are in {log_file()}."


class ProblemHooks(QObject):
    """Handlers of uncaught exceptions of all threads; ``close`` restores Python's own handlers."""

    message_posted = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._hooks: tuple[Callable[..., object], Callable[..., object]] = (sys.excepthook, threading.excepthook)
        sys.excepthook = self._on_error
        threading.excepthook = self._on_thread_error

    def close(self) -> None:
        """Restore the previous handlers."""
        sys.excepthook, threading.excepthook = self._hooks

    def _on_error(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            self._hooks[0](kind, error, trace)
            return
        if not isinstance(error, StudioError):
            _log.error("An exception reached the event loop", exc_info=(kind, error, trace))
        self.message_posted.emit(error_sentence(error))

    def _on_thread_error(self, failure: threading.ExceptHookArgs) -> None:
        if failure.exc_value is not None:
            self._on_error(failure.exc_type, failure.exc_value, failure.exc_traceback)
