"""File lock that the operating system releases when its process ends."""

import os
import sys
from functools import partial
from pathlib import Path
from typing import IO

if sys.platform == "win32":
    import msvcrt

    def _lock(stream: IO[bytes]) -> None:
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(stream: IO[bytes]) -> None:
        fcntl.flock(stream.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


class FileLock:
    """File lock that is held from ``acquired`` until ``release`` or the end of the process."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream

    @classmethod
    def acquired(cls, path: Path) -> "FileLock | None":
        """Acquired lock at ``path``; None if another process holds it. Raises OSError if the file cannot be written."""
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        stream = open(path, "ab", opener=partial(os.open, mode=0o600))  # noqa: SIM115 - open as long as the lock is held
        try:
            _lock(stream)
        except OSError:
            stream.close()
            return None
        return cls(stream)

    def release(self) -> None:
        """Release the lock. Its file is kept: if it were removed, two processes could lock files of the same name."""
        self._stream.close()


def journal_folder() -> Path:
    """Folder of journals and locks, in the user's state folder."""
    import platformdirs

    return Path(os.fspath(platformdirs.user_state_path("morpho-studio"))) / "journal"
