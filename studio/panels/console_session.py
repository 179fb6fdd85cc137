"""Python statements that edit the window's document, run in another thread so that the window stays responsive."""

import ast
import codeop
import contextlib
import ctypes
import io
import threading
import traceback
from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar

from PySide6.QtCore import QObject, Qt, Signal, SignalInstance

from studio.core.errors import StudioError
from studio.document.document import Document

Result = TypeVar("Result")
CONSOLE_FILE = "<console>"
_WAIT = 0.1
"""Seconds between two checks by a waiting statement if the window was closed."""


class WindowThread(QObject):
    """Executor on the window's thread: other threads run functions there and wait for the results."""

    _asked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.closed = False
        self._home = threading.get_ident()
        self._asked.connect(self._run, Qt.ConnectionType.QueuedConnection)

    def run(self, work: Callable[[], Result]) -> Result:
        """Result of ``work``, run on the window's thread. Exceptions of ``work`` are raised; SystemExit once the window
        is closed.
        """
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

    def _run(self, call: "_Call[object]") -> None:
        call()


class _Call(Generic[Result]):
    result: Result

    def __init__(self, work: Callable[[], Result]) -> None:
        self._work = work
        self.done = threading.Event()
        self.error: BaseException | None = None

    def __call__(self) -> None:
        try:
            self.result = self._work()
        except BaseException as error:  # noqa: BLE001 - raised again by the thread that asked
            self.error = error
        finally:
            self.done.set()


class OnWindowThread:
    """Proxy of a QObject for use from another thread: its methods run on the window's thread."""

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
    """Proxy of the window's document for edits from another thread.

    No undo step is left open while the window handles events: edits inside ``group`` belong to one gesture, so that an
    edit of the user in between becomes a step of its own and splits the group into two steps.
    """

    def __init__(self, target: Document, thread: WindowThread) -> None:
        super().__init__(target, thread)
        self._document = target
        self.step: tuple[str, int] | None = None
        """Text and gesture of the group that is open."""

    def __getattr__(self, name: str) -> object:
        value = super().__getattr__(name)
        if not callable(value) or self.step is None:
            return value
        method, step = getattr(self._target, name), self.step

        def edit(*arguments: object, **named: object) -> object:
            with self._document.group(*step):
                return method(*arguments, **named)

        return lambda *arguments, **named: self._thread.run(lambda: edit(*arguments, **named))

    @contextlib.contextmanager
    def group(self, text: str, gesture: int | None = None) -> Iterator[None]:
        """Context whose edits are one undo step; an exception reverts them, back to the last edit of the user in
        between.
        """
        if self.step is not None:
            yield
            return
        number = self._thread.run(self._document.new_gesture) if gesture is None else gesture
        self.step = text, number
        try:
            yield
        except BaseException:
            self._thread.run(lambda: self._document.undo_gesture(number))
            raise
        finally:
            self.step = None


class ConsoleSession(QObject):
    """Namespace in which statements run; ``scene`` is the open project and ``api`` is ``studio.api``."""

    written = Signal(str)
    """Emitted with text that a statement prints, or with its value."""
    ended = Signal()
    """Emitted when a statement has ended or was stopped."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self._window = WindowThread()
        self._document = DocumentOnWindowThread(document, self._window)
        self._running: threading.Thread | None = None
        self._stoppable, self._stopping = False, threading.Lock()
        """True while a KeyboardInterrupt would be raised in the statement; the lock is held while it is sent."""
        self.namespace: dict[str, object] = {}
        self.ended.connect(self._end)  # on the window's thread, after all that was written

    @property
    def running(self) -> bool:
        """True while a statement runs."""
        return self._running is not None

    def is_whole(self, source: str) -> bool:
        """True if ``source`` can be run: it is complete, or invalid whatever follows."""
        try:
            return codeop.compile_command(source, CONSOLE_FILE, "exec") is not None
        except (SyntaxError, ValueError, OverflowError):
            return True

    def run(self, source: str) -> None:
        """Run statements in the background and emit ``ended`` afterwards. Raises RuntimeError if others are running."""
        if self._running is not None:
            raise RuntimeError("a statement is still running")
        self._running = threading.Thread(target=self._work, args=(source,), daemon=True, name="console")
        self._running.start()

    def stop(self) -> None:
        """Raise KeyboardInterrupt in the running statement, at its next Python instruction."""
        with self._stopping:
            if self._running is not None and self._running.ident is not None and self._stoppable:
                _send(self._running.ident, ctypes.py_object(KeyboardInterrupt))

    def close(self) -> None:
        """Release the project; a running statement is stopped without waiting for it."""
        self._window.closed = True
        self.stop()
        self.namespace.clear()

    def _end(self) -> None:
        self._running = None

    def _work(self, source: str) -> None:
        try:
            self._document.step = None  # a statement that was stopped may have left it
            self._stoppable = True
            self._run_statement(source)
        except KeyboardInterrupt:
            pass  # it came as the statement had ended
        finally:
            self._end_stopping()
            if self._window.closed:
                self._running = None
            else:
                self.ended.emit()

    def _end_stopping(self) -> None:
        """Cancel a KeyboardInterrupt that was not raised yet, and allow no further one."""
        while True:
            try:
                with self._stopping:
                    self._stoppable = False
                _send(threading.get_ident(), None)
                break
            except KeyboardInterrupt:
                continue

    def _run_statement(self, source: str) -> None:
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

    def _execute(self, source: str) -> None:
        """Run all statements; the value of a final expression is printed and stored as ``_``."""
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

        document: Any = self._document
        return {"__name__": "__console__", "api": api, "scene": api.Scene(document)}


def _send(thread: int, error: object) -> None:
    """Raise an exception in a thread at its next Python instruction; None cancels one that was not raised yet."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), error)


class _Output(io.TextIOBase):
    """Standard output of statements, sent as a signal."""

    def __init__(self, written: SignalInstance) -> None:
        self._written = written

    def write(self, text: str) -> int:
        self._written.emit(text)
        return len(text)
