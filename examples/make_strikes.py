"""Make the strikes of the bundled motion library, by two actors: python examples/make_strikes.py [FOLDER] [NAME...]."""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from studio.startup.process import prepare_process

prepare_process()

from keyed.strikes import SECOND_ACTOR, STRIKES  # noqa: E402
from keyed.write import write_capture  # noqa: E402

from studio.core.mannequin.physique import Physique  # noqa: E402
from studio.core.normalized.normalize import detected_contacts, normalize_capture  # noqa: E402
from studio.core.solver.adapt import adapt  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.io.bvh.writer import write_bvh  # noqa: E402
from studio.io.export import take_of_adapted  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402

SMALL = Physique(stature=1.58, hip_height=0.505, shoulder_width=0.205, upper_arm=0.165, forearm=0.145)
"""The second actor: shorter legs and arms than the first, also for her stature."""


def main(arguments: list[str]) -> None:
    """Write each strike into the folder, by default examples/strikes."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent / "strikes"
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or STRIKES:
        path = folder / f"{name}.bvh"
        if name in SECOND_ACTOR:
            frames = write_performed_by(SMALL, path)
        else:
            frames = write_capture(path, STRIKES[name].targets())
        print(f"{name}: {frames} frames, {path.stat().st_size // 1000} kB")


def write_performed_by(physique: Physique, path: Path) -> int:
    """The strike that is named as ``path`` is, adapted to another body and written on its own joints."""
    with TemporaryDirectory() as folder:
        keyed = Path(folder) / path.name
        write_capture(keyed, STRIKES[path.stem].targets())
        capture = load_capture(keyed)
    motion, actor = normalize_capture(capture)
    body = physique.morphology()
    request = AdaptRequest(motion, body, detected_contacts(capture, ""), actor=actor.morphology)
    take = take_of_adapted(path.stem, adapt(request))
    write_bvh(path, take.skeleton, take.poses, take.frame_rate, decimals=4)
    return take.poses.frame_count


if __name__ == "__main__":
    main(sys.argv[1:])
