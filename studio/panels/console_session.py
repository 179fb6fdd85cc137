"""Python statements on a document of the window, run in another thread so that nothing freezes."""

import ast
import codeop
import contextlib
import ctypes
import io
import threading
import traceback
from collections.abc import Callable, Iterator
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal, SignalInstance

from studio.core.errors import StudioError
from studio.document.document import Document

CONSOLE_FILE = "<console>"
_WAIT = 0.1
"""Seconds between two checks of a waiting statement that the window is still open."""


class WindowThread(QObject):
    """Thread of the window: other threads run functions on it and wait for the results."""

    _asked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.closed = False
        self._home = threading.get_ident()
        self._asked.connect(self._run, Qt.ConnectionType.QueuedConnection)

    def run(self, work: Callable[[], object]) -> object:
        """Result of ``work``, run on the window's thread. Raises its error, or SystemExit once the window is closed."""
        if threading.get_ident() == self._home:
            return work()
        call = _Call(work)
        self._asked.emit(call)
        while not call.done.wait(_WAIT):
            if self.closed:
                raise SystemExit
        if call.error is not None:
            raise call.error
        return call.result

    def _run(self, call: "_Call") -> None:
        call()


class _Call:
    def __init__(self, work: Callable[[], object]) -> None:
        self._work = work
        self.done = threading.Event()
        self.result: object = None
        self.error: BaseException | None = None

    def __call__(self) -> None:
        try:
            self.result = self._work()
        except BaseException as error:  # noqa: BLE001 - raised again by the thread that asked
            self.error = error
        finally:
            self.done.set()


class OnWindowThread:
    """Proxy of a QObject of the window for another thread: its methods run on the window's thread."""

    def __init__(self, target: QObject, thread: WindowThread) -> None:
        self._target, self._thread = target, thread

    def __getattr__(self, name: str) -> object:
        value = getattr(self._target, name)
        if isinstance(value, QObject):
            return OnWindowThread(value, self._thread)
        if not callable(value):
            return value
        return lambda *arguments, **named: self._thread.run(lambda: value(*arguments, **named))


class DocumentOnWindowThread(OnWindowThread):
    """The window's document, edited from another thread."""

    @contextlib.contextmanager
    def group(self, text: str) -> Iterator[None]:
        """One undo step of all edits inside, as ``EditedProject.group``."""
        step = contextlib.ExitStack()
        self._thread.run(lambda: step.enter_context(self._target.group(text)))  # type: ignore[attr-defined]
        try:
            yield
        except BaseException as error:
            raised = error  # the name of an ``except`` clause ends with it
            self._thread.run(lambda: step.__exit__(type(raised), raised, raised.__traceback__))
            raise
        else:
            self._thread.run(step.close)


class ConsoleSession(QObject):
    """One namespace of Python, in which ``scene`` is the open project and ``api`` is ``studio.api``."""

    written = Signal(str)
    """Text that a statement prints, or its value."""
    ended = Signal()
    """A statement has run, or was stopped."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self._document = document
        self._window = WindowThread()
        self._running: threading.Thread | None = None
        self.namespace: dict[str, object] = {}
        self.ended.connect(self._end)  # on the window's thread, after all that was written

    @property
    def running(self) -> bool:
        """True while a statement runs."""
        return self._running is not None

    def is_whole(self, source: str) -> bool:
        """True if ``source`` can be run as it stands: it is complete, or invalid whatever follows."""
        try:
            return codeop.compile_command(source, CONSOLE_FILE, "exec") is not None
        except (SyntaxError, ValueError, OverflowError):
            return True

    def run(self, source: str) -> None:
        """Run statements in the background; ``ended`` is emitted afterwards. RuntimeError while others run."""
        if self._running is not None:
            raise RuntimeError("a statement is still running")
        self._running = threading.Thread(target=self._work, args=(source,), daemon=True, name="console")
        self._running.start()

    def stop(self) -> None:
        """Raise KeyboardInterrupt in the running statement, at its next step in Python."""
        if self._running is not None and self._running.ident is not None:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(
                ctypes.c_ulong(self._running.ident), ctypes.py_object(KeyboardInterrupt)
            )

    def close(self) -> None:
        """Release everything; a running statement is stopped without waiting for it."""
        self._window.closed = True
        self.stop()
        self.namespace.clear()

    def _end(self) -> None:
        self._running = None

    def _work(self, source: str) -> None:
        output = _Output(self.written)
        try:
            with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
                self._execute(source)
        except (SystemExit, KeyboardInterrupt) as ended:
            output.write(f"{type(ended).__name__}\n")
        except StudioError as error:
            output.write(f"{error}\n")
        except BaseException as error:  # noqa: BLE001 - a statement may raise anything; the user reads it
            frames = error.__traceback__
            while frames is not None and frames.tb_frame.f_code.co_filename != CONSOLE_FILE:
                frames = frames.tb_next
            output.write("".join(traceback.format_exception(type(error), error, frames)))
        finally:
            if self._window.closed:
                self._running = None
            else:
                self.ended.emit()

    def _execute(self, source: str) -> None:
        """Run all statements; the value of a last expression is printed and kept as ``_``."""
        if not self.namespace:
            self.namespace.update(self._beginning())
        tree = ast.parse(source, CONSOLE_FILE)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, CONSOLE_FILE, "exec"), self.namespace)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), CONSOLE_FILE, "eval"), self.namespace)
            if value is not None:
                self.namespace["_"] = value
                print(repr(value))

    def _beginning(self) -> dict[str, object]:
        from studio import api  # late: scripts are rare, and it loads what renders and searches

        document: Any = DocumentOnWindowThread(self._document, self._window)
        return {"__name__": "__console__", "api": api, "scene": api.Scene(document)}


class _Output(io.TextIOBase):
    """Standard output redirected to a signal."""

    def __init__(self, written: SignalInstance) -> None:
        self._written = written

    def write(self, text: str) -> int:
        self._written.emit(text)
        return len(text)
