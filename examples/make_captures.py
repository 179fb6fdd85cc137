"""Make the captures that come with the studio: python examples/make_captures.py [FOLDER] [NAME...]."""

import sys
from pathlib import Path

from keyed.clips import CLIPS
from keyed.write import write_capture


def main(arguments: list[str]) -> None:
    """Write each clip into the folder, by default examples/captures."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent / "captures"
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or CLIPS:
        path = folder / f"{name}.bvh"
        frames = write_capture(path, CLIPS[name]())
        print(f"{name}: {frames} frames, {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
