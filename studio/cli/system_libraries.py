"""The system's libraries that Qt and VTK load while they run, and which of them are not there.

Both end the process where one is missing, so it is asked before they are. ``python system_libraries.py`` prints the
Debian packages that lack; it runs before anything is installed, and so imports only what Python brings.
"""

import ctypes
import sys
from collections.abc import Mapping
from pathlib import Path

DRAWING = {"libEGL.so.1": "libegl1", "libGL.so.1": "libgl1"}
"""Debian's packages by library: what pictures are drawn with."""
WINDOW = {
    "libglib-2.0.so.0": "libglib2.0-0",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-shape.so.0": "libxcb-shape0",
}
"""What a window takes beside."""
LIKED = {"libXcursor.so.1": "libxcursor1"}
"""What it can do without."""
FONTS, FONT_PACKAGE = Path("/usr/share/fonts"), "fonts-dejavu-core"


def missing(libraries: Mapping[str, str]) -> dict[str, str]:
    """Those that cannot be loaded."""
    return {name: package for name, package in libraries.items() if not _loads(name)}


def sentence_about(libraries: Mapping[str, str]) -> str:
    """What to say, and to type, where some are missing."""
    packages = " ".join(dict.fromkeys(libraries.values()))
    return f"System libraries are missing: {', '.join(libraries)}. Type: sudo apt-get install -y {packages}"


def _loads(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


if __name__ == "__main__" and sys.platform.startswith("linux"):
    lacking = list(missing({**DRAWING, **WINDOW, **LIKED}).values())
    print(*lacking, *([] if FONTS.is_dir() and any(FONTS.rglob("*.[to]tf")) else [FONT_PACKAGE]))
