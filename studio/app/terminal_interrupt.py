"""Ctrl+C in the terminal from which the window was started."""

import signal
import socket

from PySide6.QtCore import QObject, QSocketNotifier, QTimer, Signal


class TerminalInterrupt(QObject):
    """Qt signal for Ctrl+C, in place of a KeyboardInterrupt, which would end the process from within Qt.

    Python runs its signal handler between two of its own instructions, of which an idle window executes none; a socket
    wakes it.
    """

    pressed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._reading, self._writing = socket.socketpair()
        for end in (self._reading, self._writing):
            end.setblocking(False)
        self._notifier = QSocketNotifier(self._reading.fileno(), QSocketNotifier.Type.Read, self)
        self._notifier.activated.connect(self._wake)
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a process in the background ignores it
            signal.set_wakeup_fd(self._writing.fileno(), warn_on_full_buffer=False)
            signal.signal(signal.SIGINT, lambda _signal, _frame: QTimer.singleShot(0, self, self.pressed.emit))

    def _wake(self) -> None:
        self._reading.recv(4096)
