"""System libraries that Qt and VTK load at run time, and a check for missing ones.

Both end the process if one is missing, so they are checked before. ``python system_libraries.py`` prints the missing
Debian packages; it runs before anything is installed, and so imports only the standard library.
"""

import ctypes
import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

DRAWING_LIBRARIES = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libxkbcommon.so.0": "libxkbcommon0",
}
"""Libraries needed to draw pictures, with their Debian packages. Debian 13 accepts ``libglib2.0-0`` for its
own name.
"""
WINDOW_LIBRARIES = {
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-randr.so.0": "libxcb-randr0",
    "libxcb-shape.so.0": "libxcb-shape0",
    "libxcb-sync.so.1": "libxcb-sync1",
    "libxcb-xfixes.so.0": "libxcb-xfixes0",
    "libxcb-xkb.so.1": "libxcb-xkb1",
    "libX11-xcb.so.1": "libx11-xcb1",
}
"""Libraries that a window needs in addition to ``DRAWING_LIBRARIES``, with their Debian packages."""
OPTIONAL_LIBRARIES = {"libXcursor.so.1": "libxcursor1"}
"""Optional libraries of a window, with their Debian packages."""
FONTS_FOLDER, FONT_PACKAGE = Path("/usr/share/fonts"), "fonts-dejavu-core"


def missing_libraries(libraries: Mapping[str, str]) -> dict[str, str]:
    """Libraries that cannot be loaded, with their Debian packages."""
    return {name: package for name, package in libraries.items() if not _loads(name)}


def missing_packages() -> list[str]:
    """Debian packages that are missing for pictures and a window."""
    fonts = [] if FONTS_FOLDER.is_dir() and any(FONTS_FOLDER.rglob("*.[to]tf")) else [FONT_PACKAGE]
    return list(
        dict.fromkeys(
            [*missing_libraries({**DRAWING_LIBRARIES, **WINDOW_LIBRARIES, **OPTIONAL_LIBRARIES}).values(), *fonts]
        )
    )


def sentence_about(libraries: Mapping[str, str]) -> str:
    """Sentence about missing libraries, with the command that installs everything for pictures and a window."""
    return f"System libraries are missing: {', '.join(libraries)}. {installation_advice(missing_packages())}"


def installation_advice(packages: list[str]) -> str:
    """Sentence with the command that installs packages, as root or as the user of this process."""
    if shutil.which("apt-get") is None:
        return f"Install what your system has for Debian's packages {' '.join(packages)}."
    line = f"apt-get update && apt-get install -y {' '.join(packages)}"
    if os.geteuid() == 0:
        return f"Type: {line}"
    return f"Type: {'sudo sh' if shutil.which('sudo') else 'su'} -c '{line}'"


def _loads(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


if __name__ == "__main__" and sys.platform.startswith("linux"):
    print(*missing_packages())
