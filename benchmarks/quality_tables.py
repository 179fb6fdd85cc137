"""Measure round trip and adaptation over a folder of captures, and write the tables in docs.

    python benchmarks/quality_tables.py [FOLDER]

FOLDER is searched for BVH files; by default the captures beside the checkout.
"""

import sys
from math import degrees, isnan
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.cli.process import prepare_process  # noqa: E402

prepare_process()

from studio.cli.adapt_report import Record, character_report  # noqa: E402
from studio.cli.adaptation import ReadyCapture, made_ready  # noqa: E402
from studio.core.grounds.ground import Ground  # noqa: E402
from studio.core.normalized.round_trip import round_trip  # noqa: E402
from studio.core.quality.motion_quality import MotionQuality, motion_quality  # noqa: E402
from studio.core.solver.adapt import adapt  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.io.character_file import bundled_characters  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402

CAPTURES = ROOT.parent / "shared" / "captures" / "bvh"
DOCS = ROOT / "docs"

ROUND_TRIP = """# Round trip

A capture is made independent of its actor's measures, then realised on the same actor again. The table has the
greatest difference, over every joint and every frame, of position and of rotation in the world; the aim is 0.1 mm
and 0.01 degrees. Written by `benchmarks/quality_tables.py`; `info` prints the same figures for any file.

"""
QUALITY = """# Quality of adaptation

Every capture on the five bundled characters with detected contacts and no constraints; each figure is the worst of
the five. *Slide* is how far a standing heel, toe, hand, knee or seat moves along the ground, *float* and *below* how
far it is off the ground (aims: 1 mm, 2 mm, 2 mm). *Acceleration* compares the greatest angular acceleration of arms
and legs with the capture's own: 1 is as smooth, a popping knee shows as 5 and more. *Speed* compares the greatest
angular speed of any joint with the same joint's in the capture, toes that bend over the floor among them. *Knees* are
how many degrees more than the capture's those of standing legs are bent, mean and most; *hips* how much lower they
ride, mean, and *bob* their ups and downs beside the capture's; *sunk* is how far any joint, hands among them, is deeper
in the ground than the capture's; *jump* and *peak* compare each joint's greatest step and each segment's greatest
acceleration, hands, toes, clavicles and spine among them, with its own in the capture; lengths as if legs had 85 cm.
Written by `benchmarks/quality_tables.py`; `adapt` reports the first five for any capture and character, and
`benchmarks/motion_tables.py` prints the others, the actor's own body among the bodies.

"""
SEEN = {
    "knees mean": ("knee_mean", degrees(1.0)), "knees most": ("knee_most", degrees(1.0)), "hips mm": ("drop", 1e3),
    "bob": ("bob", 1.0), "sunk mm": ("below", 1e3), "jump": ("jump", 1.0), "peak": ("peak", 1.0),
}  # fmt: skip
"""Titles of what an animator would see, fields of ``MotionQuality``, and their factors."""
_KEYS = ("slide_mm", "float_mm", "penetration_mm", "acceleration_ratio", "speed_ratio")


def main() -> int:
    """Read every file once, write both tables."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else CAPTURES
    files = sorted(folder.rglob("*.bvh"))
    if not files:
        print(f"No BVH files in {folder}. Name a folder that has some.", file=sys.stderr)
        return 1
    trips, qualities, others = [], [], []
    for file in files:
        capture = load_capture(file)
        if capture.body_map is None:
            others.append(file.stem)
            continue
        ready = made_ready(capture)
        trips.append(trip_row(ready))
        qualities.append(quality_row(ready))
        print(file.stem, *qualities[-1][1:])
    summary = f"{len(trips)} of {len(files)} files hold a human body; no body: {', '.join(others) or 'none'}.\n\n"
    worst = [f"**worst of {len(trips)}**", "", *(f"**{max(float(row[k]) for row in trips):.1e}**" for k in (2, 3))]
    titles = ("capture", "frames", "position mm", "rotation degrees")
    DOCS.mkdir(exist_ok=True)
    (DOCS / "round_trip.md").write_text(ROUND_TRIP + summary + table(titles, [*trips, worst]), encoding="utf-8")
    columns = list(zip(*qualities, strict=True))[1:]
    worst = ["**worst**", *(f"**{max(float(each) for each in column if each != '-'):.2f}**" for column in columns)]
    figures = "capture", "slide mm", "float mm", "below mm", "acceleration", "speed", *SEEN
    (DOCS / "adaptation_quality.md").write_text(QUALITY + table(figures, [*qualities, worst]), encoding="utf-8")
    return 0


def trip_row(ready: ReadyCapture) -> list[str]:
    """Name, frames, and the worst errors of a capture's round trip."""
    error = round_trip(ready.capture, ready.motion, ready.actor)
    return [
        ready.capture.name,
        str(ready.capture.frame_count),
        f"{1000.0 * error.position:.1e}",
        f"{degrees(error.rotation):.1e}",
    ]


def quality_row(ready: ReadyCapture) -> list[str]:
    """Name, and for each figure the worst over the bundled characters."""
    reports: list[Record] = []
    seen: list[MotionQuality] = []
    first = ready.capture.first_frame
    for character in bundled_characters().values():
        request = AdaptRequest(ready.motion, character.morphology, ready.contacts)
        reports.append(character_report(request, ready.source, first)[1])
        seen.append(motion_quality(adapt(request), ready.source, ready.contacts, Ground(), first))
    figures = [max(report[key] for report in reports) for key in _KEYS]
    figures += [factor * max(getattr(each, name) for each in seen) for name, factor in SEEN.values()]
    return [ready.capture.name, *("-" if isnan(figure) else f"{figure:.2f}" for figure in figures)]


def table(titles: tuple[str, ...], rows: list[list[str]]) -> str:
    """A Markdown table, figures right-aligned."""
    lines = [titles, ("---", *("---:" for _ in titles[1:])), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    sys.exit(main())
