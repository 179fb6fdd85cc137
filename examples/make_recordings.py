"""Make the recordings that the tests adapt: python examples/make_recordings.py FOLDER [NAME...]."""

import sys
from pathlib import Path

from keyed.recording import RECORDINGS, write_recording


def main(arguments: list[str]) -> None:
    """Write each recording into the folder."""
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or RECORDINGS:
        path = folder / f"{name}.bvh"
        frames = write_recording(name, path)
        print(f"{name}: {frames} frames, {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
