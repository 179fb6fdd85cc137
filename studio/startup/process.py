"""Process setup before all other imports of the studio."""

import atexit
import ctypes
import faulthandler
import gc
import hashlib
import os
import platform
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import platformdirs

from studio.core.errors import StudioError
from studio.startup.system_libraries import DRAWING_LIBRARIES, WINDOW_LIBRARIES, missing_libraries, sentence_about

LARGEST_KEPT_BYTES, MOST_KEPT_BYTES = 32 << 20, 256 << 20
"""Largest freed block of memory that is kept, and maximum of all freed memory that is kept, in bytes."""
MEMORY_ARENAS = 2
"""Number of heaps (glibc arenas) that threads share: each keeps its freed memory; glibc's default is eight per core."""
COLLECTION_THRESHOLDS = (50_000, 20, 20)
"""Thresholds of garbage collection (``gc.set_threshold``), the first in objects created between two collections."""
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
MOST_CACHES = 16
"""Number of caches of compiled kernels that are kept, of 9 MB each: one for each checkout, machine and
version in use.
"""
KERNELS_FOLDER = Path(__file__).resolve().parents[1] / "core" / "kernels"
"""Folder of the sources of the kernels."""


def prepare_process() -> None:
    """Set up the process: folder of compiled kernels, memory, stack traces after a crash in C++, drawing without a
    display.

    Must run before numba and VTK are imported, because both read the environment only once.
    """
    # A window started from a desktop icon may have no standard error; tests watch for crashes by themselves.
    if sys.stderr is not None and not faulthandler.is_enabled():
        faulthandler.enable()
    name_kernel_cache()
    # numba colours sentences that nobody reads: a twentieth of compiling where colorama is installed.
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    if not has_display():
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    os.environ.setdefault("ALLOW_PLOTTING", "true")  # else pyvista opens a window to see whether it can
    keep_freed_memory()
    # Hardly one of the many objects that imports make is ever lost: looking among them costs a tenth of a start.
    gc.set_threshold(*COLLECTION_THRESHOLDS)


def name_kernel_cache() -> None:
    """Set numba's cache of compiled kernels to the one for the present sources.

    Must run before numba is imported. In numba's default cache beside the sources, a kernel would stay cached although
    the kernels that it calls have changed.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(writable_kernel_cache())


def keep_freed_memory() -> None:
    """Make glibc reuse freed memory instead of returning it to the system.

    Poses of a clip are a few megabytes. By default glibc returns them after a clip has been solved and requests them
    again for the next; clearing the new pages would cost more than retargeting the clip.
    """
    if (mallopt := _of_glibc("mallopt")) is not None:
        mallopt(_MMAP_THRESHOLD, LARGEST_KEPT_BYTES)
        mallopt(_TRIM_THRESHOLD, MOST_KEPT_BYTES)
        mallopt(_ARENA_MAX, MEMORY_ARENAS)


def give_back_freed_memory() -> None:
    """Return freed memory between used blocks to the system; useful after much has been freed."""
    if (malloc_trim := _of_glibc("malloc_trim")) is not None:
        malloc_trim(0)


def _of_glibc(name: str) -> Callable[..., int] | None:
    return getattr(ctypes.CDLL(None), name, None) if sys.platform.startswith("linux") else None


def writable_kernel_cache() -> Path:
    """Permanent cache folder, or a temporary one if the user's folders cannot be written.

    The ``MOST_CACHES`` most recently used caches are kept.
    """
    folder = kernel_cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_old_caches(folder)
    except OSError:
        return temporary_kernel_cache(folder.name)
    return folder


def remove_old_caches(used: Path) -> None:
    """Mark the cache ``used`` as used now, and remove all others except the ``MOST_CACHES`` most recently used."""
    os.utime(used)
    by_use = sorted((each for each in used.parent.iterdir() if each.is_dir()), key=lambda each: each.stat().st_mtime)
    for old in by_use[:-MOST_CACHES]:
        shutil.rmtree(old, ignore_errors=True)  # one that another user has made stays


def temporary_kernel_cache(name: str) -> Path:
    """Private temporary folder of this user, the same for all processes.

    numba runs the content of its cache: if another user owns the name, or may write there, the folder is made for this
    process and removed at its end, as it is on Windows, which has no numeric owners.
    """
    with suppress(OSError, AttributeError):
        shared = Path(tempfile.gettempdir(), f"morpho-studio-kernels-{os.getuid()}")
        shared.mkdir(mode=0o700, exist_ok=True)
        found = shared.lstat()
        if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077:
            folder = shared / name
            folder.mkdir(exist_ok=True)
            remove_old_caches(folder)
            return folder
    own = tempfile.mkdtemp(prefix="morpho-studio-kernels-")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return Path(own)


def kernel_cache_folder() -> Path:
    """Cache folder for exactly these kernels, their path, this Python, numba and processor.

    numba checks only the file of a kernel, not the kernels it calls from other files; with a cache for each content of
    the whole package, outdated code is never used. A checkout that was moved or copied compiles again, because numba
    stores kernels by their path. So does another kind of machine or program, from which numba would not use kernels: a
    home folder may be shared by several, or outlive them.
    """
    cache = Path(platformdirs.user_cache_dir("morpho-studio", appauthor=False))
    maker = platform.python_version(), version("numba"), version("llvmlite"), processor()
    where = hashlib.sha256("\0".join((str(KERNELS_FOLDER), *maker)).encode()).hexdigest()[:6]
    return cache / "kernels" / f"{content_digest(sorted(KERNELS_FOLDER.rglob('*.py')))}-{where}"


def processor() -> str:
    """Model name and features of the processor, which determine the compiled instructions."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine() + platform.processor()
    return "\n".join(sorted({line for line in lines if line.split("\t")[0] in ("model name", "flags", "Features")}))


def content_digest(files: Iterable[Path]) -> str:
    """Twelve hexadecimal digits that change with the name or the content of any of the files."""
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def has_display() -> bool:
    """True if a window can be shown; Linux needs an X or a Wayland display."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def check_libraries(window: bool = False) -> None:
    """Raise StudioError with a command to type if a system library is missing for pictures, or for a ``window``.

    Must run before Qt and VTK are loaded, which would end the process.
    """
    lacking = (
        missing_libraries({**DRAWING_LIBRARIES, **WINDOW_LIBRARIES} if window else DRAWING_LIBRARIES)
        if sys.platform.startswith("linux")
        else {}
    )
    if lacking:
        raise StudioError(sentence_about(lacking))
