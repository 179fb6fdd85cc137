"""Print what an animator would still clean by hand, on the five bundled bodies and the actor's own.

    python benchmarks/motion_tables.py [FOLDER ...]

FOLDERs are searched for BVH files; by default the captures beside the checkout. Each figure is the worst of the six.
"""

import math
import sys
from collections.abc import Sequence
from math import degrees
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.cli.process import prepare_process  # noqa: E402

prepare_process()

from studio.cli.adaptation import ReadyCapture, made_ready  # noqa: E402
from studio.cli.printing import print_table  # noqa: E402
from studio.core.grounds.ground import Ground  # noqa: E402
from studio.core.quality.motion_quality import PARTS, MotionQuality, motion_quality  # noqa: E402
from studio.core.solver.adapt import adapt  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.io.character_file import bundled_characters  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402

CAPTURES = ROOT.parent / "shared" / "captures" / "bvh"
TITLES = (
    "capture", "below mm", "drop cm", "knee mean", "knee most", "bob least", "bob most", "posture", "shoulders",
    "hands cm", "inside mm", "jump", *PARTS,
)  # fmt: skip


def main(folders: Sequence[str]) -> int:
    """Adapt every capture, print a line for each, and the worst of all at the end."""
    files = sorted(file for folder in folders or [CAPTURES] for file in Path(folder).rglob("*.bvh"))
    if not files:
        print(f"No BVH files in {', '.join(map(str, folders or [CAPTURES]))}. Name a folder.", file=sys.stderr)
        return 1
    rows = []
    for file in files:
        capture = load_capture(file)
        if capture.body_map is None:
            continue
        rows.append([capture.name, *worst(qualities(made_ready(capture)))])
        print(*(each if isinstance(each, str) else f"{each:.2f}" for each in rows[-1]), flush=True)
    print()
    print_table(TITLES, [[row[0], *("-" if math.isnan(each) else f"{each:.2f}" for each in row[1:])] for row in rows])
    return 0


def qualities(ready: ReadyCapture) -> list[MotionQuality]:
    """On the actor's own body, then on the bundled ones."""
    actor = ready.actor.morphology
    bodies = [(actor, None), *((each.morphology, each.volume) for each in bundled_characters().values())]
    adapted = (
        adapt(AdaptRequest(ready.motion, body, ready.contacts, volume=volume, actor=actor, clears=True))
        for body, volume in bodies
    )
    first = ready.capture.first_frame
    return [motion_quality(each, ready.source, ready.contacts, Ground(), first) for each in adapted]


def worst(found: Sequence[MotionQuality]) -> list[float]:
    """The figures of ``TITLES``: millimetres, centimetres, degrees and ratios, each the worst of the bodies'."""
    bobs = [each.bob for each in found]
    return [
        1e3 * max(each.below for each in found),
        1e2 * max((each.drop for each in found), key=abs),
        degrees(max(each.knee_mean for each in found)),
        degrees(max(each.knee_most for each in found)),
        min(bobs),
        max(bobs),
        degrees(max(each.posture for each in found)),
        max((each.shoulders for each in found), key=abs),
        1e2 * max(each.hands for each in found),
        1e3 * max(each.inside for each in found),
        max(each.jump for each in found),
        *(max(each.peaks[part] for each in found) for part in PARTS),
    ]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
