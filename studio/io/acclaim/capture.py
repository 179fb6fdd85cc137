"""Motion of an AMC file with its ASF skeleton, as a capture."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.rotations import from_euler, inverse, multiply
from studio.io.acclaim.motion import read_amc
from studio.io.acclaim.skeleton import ASF_ROOT_NAME, read_asf
from studio.io.bvh.capture import capture_of
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture

FloatArray = NDArray[np.float64]

_RATE = 120.0
"""Frames a second of nearly all such files: those of CMU."""


@dataclass(frozen=True)
class AcclaimFile:
    """Motion of an AMC file on the joints of its ASF skeleton, in the files' own units and axes."""

    skeleton: Skeleton
    rotations: FloatArray
    """Local rotations (F, J, 4), relative to the parent."""
    translations: FloatArray
    """Local translations (F, J, 3), in the parent's axes."""
    repairs: tuple[str, ...]
    frame_time: float = 1.0 / _RATE
    frame_time_digit: float = 1e-9

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.rotations)

    @property
    def stated_unit(self) -> None:
        """None: the ``length`` of an ASF file is a scale of the program that wrote it, not a unit."""

    @property
    def stated_up_axis(self) -> None:
        """None: the format has no field for the up axis."""

    def transforms(self, frames: NDArray[np.int64] | slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (N, J, 4) and translations (N, J, 3) of ``frames`` (N,)."""
        return self.rotations[frames], self.translations[frames]


def load_acclaim(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture of the AMC file at ``path`` on the skeleton of the matching ASF file in its folder."""
    file = read_acclaim(path, lambda share, text: progress(0.6 * share, text))

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        capture = capture_of(file, path, options, progress)
        if options.frame_rate is not None:
            return capture
        reason = "AMC files do not say it; nearly all were recorded so."
        return capture.with_guess(Guess("frame rate", f"{_RATE:g} fps", reason, Confidence.DOUBTFUL))

    return ReadCapture(interpret(options, progress), interpret=interpret)


def read_acclaim(path: Path, progress: Progress = lambda share, text: None) -> AcclaimFile:
    """Content of the AMC file at ``path`` with its skeleton. Raises StudioError with file, line and what to do."""
    progress(0.0, f"Reading {path.name}")
    repairs: list[str] = []
    body = read_asf(_skeleton_of(path, repairs))
    skeleton = body.skeleton
    channels = {
        name: own
        for name, own, end in zip(skeleton.names, body.channels, skeleton.end_sites.tolist(), strict=True)
        if not end
    }
    motion = read_amc(path, channels, body.degrees, lambda share: progress(0.8 * share, f"Reading {path.name}"))
    rotations = np.zeros((motion.frame_count, skeleton.joint_count, 4))
    rotations[..., 3] = 1.0
    translations = np.tile(skeleton.offsets, (motion.frame_count, 1, 1))
    for name, values in motion.values.items():
        joint, own = skeleton.names.index(name), channels[name]
        if "l" in own:
            repairs.append(f"{path.name}: '{name}' changes its length; it was kept as its skeleton has it.")
        turns = [place for place, channel in enumerate(own) if channel.startswith("r")]
        moves = [place for place, channel in enumerate(own) if channel.startswith("t")]
        translations[:, joint, ["xyz".index(own[place][1]) for place in moves]] += values[:, moves]
        if turns:
            angles = np.radians(values[:, turns[::-1]]) if motion.degrees else values[:, turns[::-1]]
            turned = from_euler("".join(own[place][1] for place in turns[::-1]), angles)
            axes = body.axes[joint]
            # The root has its own turn before that of the motion, a bone turns about axes that stay with its parent.
            rotations[:, joint] = (
                multiply(turned, axes) if name == ASF_ROOT_NAME else multiply(multiply(axes, turned), inverse(axes))
            )
    progress(1.0, f"Read {path.name}")
    return AcclaimFile(skeleton, rotations, translations, (*repairs, *motion.repairs))


def _skeleton_of(path: Path, repairs: list[str]) -> Path:
    """Path of the ASF file in the folder of the motion: with its name, a prefix of it (``07.asf`` for ``07_01.amc``),
    or the only one.

    Raises StudioError if ``path`` is a skeleton itself, or has none.
    """
    if path.suffix.lower() == ".asf":
        raise StudioError(f"{path.name} is a skeleton without a motion. Choose the AMC file that moves it.")
    beside = sorted(each for each in path.absolute().parent.iterdir() if each.suffix.lower() == ".asf")
    by_stem = {each.stem.lower(): each for each in beside}
    stem = path.stem.lower()
    for name in (stem, stem.rpartition("_")[0], stem.partition("_")[0]):
        if name in by_stem:
            return by_stem[name]
    if len(beside) == 1:
        repairs.append(f"{path.name}: its skeleton was taken from {beside[0].name}, the only ASF file of its folder.")
        return beside[0]
    found = f"holds {len(beside)}, none of its name" if beside else "holds none"
    wanted = f"{path.stem.partition('_')[0]}.asf"
    raise StudioError(
        f"{path.name} needs its skeleton, an ASF file, and its folder {found}. Put it there, called {wanted}."
    )
