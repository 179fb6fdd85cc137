"""Atomic writing of files: a new file is written beside the old one, flushed to the disk, and renamed."""

import contextlib
import errno
import os
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from studio.core.errors import StudioError

_SUFFIX = ".part"
_WRONG_PLACE = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT, errno.ENOTDIR)
_FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)
_NO_SUCH_THING = (errno.EINVAL, errno.ENOTSUP)  # some network drives cannot see a folder onto the disk
_UNTOUCHED = "Nothing was changed on the disk."


class FolderNotWritable(StudioError):  # noqa: N818 - it names what is the matter
    """Error: a file cannot be written in its folder, but may be written in another one."""


@contextmanager
def atomic_replacement(path: Path) -> Iterator[Path]:
    """Context with the path of an empty file, which replaces ``path`` at the end of the block; see
    ``atomic_replacements``.
    """
    with atomic_replacements(path) as (part,):
        yield part


@contextmanager
def atomic_replacements(*paths: Path) -> Iterator[tuple[Path, ...]]:
    """Context with the paths of empty files to fill; they replace ``paths``, in order, once all are on the disk.

    Each file keeps the mode of the file that it replaces, or has the default mode; a link stays, and its target is
    replaced. If the block raises, ``paths`` are unchanged and no file is left beside them. Raises FolderNotWritable if
    another folder is needed, and StudioError for any other OSError, also of the block.
    """
    targets = [Path(os.path.realpath(path)) for path in paths]
    parts = [part_of(target) for target in targets]
    current = targets[0]
    try:
        for current, part in zip(targets, parts, strict=True):
            _begin(current, part)
        yield tuple(parts)
        for part in parts:
            _see_onto_disk(part)
        for current, part in zip(targets, parts, strict=True):
            os.replace(part, current)
        for folder in {target.parent for target in targets}:
            _see_folder_onto_disk(folder)
    except OSError as error:
        raise _refusal(current, error) from error
    finally:
        for part in parts:
            with contextlib.suppress(OSError):  # the first error is the one to tell
                part.unlink(missing_ok=True)


def write_atomically(path: Path, content: bytes) -> None:
    """Replace the file ``path`` by ``content``, or leave it unchanged. Raises FolderNotWritable or StudioError."""
    with atomic_replacement(path) as part:
        part.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write ``text`` as UTF-8, atomically; bytes of file names that are not UTF-8 become escapes, as in JSON."""
    write_atomically(path, text.encode(errors="backslashreplace"))


def write_pieces(path: Path, pieces: Iterable[bytes | memoryview]) -> None:
    """Write a content in pieces, atomically; their iterator may raise an exception to cancel."""
    with atomic_replacement(path) as part, open(part, "wb") as file:
        file.writelines(pieces)


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """Context with a folder to fill, which becomes ``path`` at the end of the block; nothing of it stays if the block
    raises.

    Raises StudioError if ``path`` exists and is not an empty folder, or if it cannot be written.
    """
    target = Path(os.path.realpath(path))
    part = part_of(target)
    try:
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise StudioError(f"'{path}' is there already and not empty. {_UNTOUCHED} Choose a new folder.")
        part.mkdir()
        yield part
        for item in part.iterdir():
            _see_onto_disk(item)
        if target.exists():
            target.rmdir()
        os.replace(part, target)
        _see_folder_onto_disk(target.parent)
    except OSError as error:
        raise _refusal(target, error) from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def part_of(path: Path) -> Path:
    """Path beside ``path`` that no other process or thread uses."""
    return path.with_name(f".{path.name}.{os.getpid()}-{secrets.token_hex(4)}{_SUFFIX}")


def remove_leftovers(path: Path) -> None:
    """Remove files left beside ``path`` by writers that were killed; call it only if no other process writes ``path``
    now.
    """
    with contextlib.suppress(OSError):  # where files cannot be removed, writing says so
        for item in path.parent.iterdir():
            if item.name.startswith(f".{path.name}.") and item.suffix == _SUFFIX:
                item.unlink(missing_ok=True)


def _begin(target: Path, part: Path) -> None:
    if target.exists() and not target.is_file():
        raise StudioError(f"'{target}' could not be written: it is not an ordinary file. Choose another name.")
    if target.exists() and not os.access(target, os.W_OK):  # a rename would not ask
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    with open(part, "xb"):
        pass
    if target.exists():
        part.chmod(target.stat().st_mode & 0o777)


def _see_onto_disk(part: Path) -> None:
    with open(part, "r+b") as stream:
        os.fsync(stream.fileno())


def _see_folder_onto_disk(folder: Path) -> None:
    if not hasattr(os, "O_DIRECTORY"):  # Windows opens no folder
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in _NO_SUCH_THING:
            raise
    finally:
        os.close(handle)


def _refusal(path: Path, error: OSError) -> StudioError:
    reason = error.strerror or str(error)
    if error.errno in _WRONG_PLACE:
        return FolderNotWritable(f"'{path}' could not be written: {reason}. {_UNTOUCHED} Choose another folder.")
    if error.errno in _FULL:
        return StudioError(
            f"There is no room for '{path.name}' ({reason}). {_UNTOUCHED} Make room or choose another disk."
        )
    return StudioError(f"'{path}' could not be written: {reason}. {_UNTOUCHED} Choose another name or folder.")
