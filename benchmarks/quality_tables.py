"""Measure round trip and adaptation over a folder of captures, and write the tables in docs.

    python benchmarks/quality_tables.py [FOLDER]

FOLDER is searched for BVH files; by default the captures beside the checkout.
"""

import sys
from collections.abc import Sequence
from math import degrees, isnan
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.cli.process import prepare_process  # noqa: E402

prepare_process()

from studio.cli.adapt_report import Record, figures  # noqa: E402
from studio.cli.adaptation import ReadyCapture, made_ready  # noqa: E402
from studio.core.grounds.ground import Ground  # noqa: E402
from studio.core.normalized.round_trip import round_trip  # noqa: E402
from studio.core.quality.motion_quality import PARTS, MotionQuality, motion_quality  # noqa: E402
from studio.core.solver.adapt import hold  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.core.solver.standing.stand import standing_of  # noqa: E402
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

Every capture on the five bundled characters with detected contacts and no constraints, arms out of the own body; each
figure is the worst of the five. *Slide* is how far a standing heel, toe, hand, knee or seat moves along the ground,
*float* and *below* how far it is off the ground. *Knees* are how many degrees more than the capture's those of standing
legs are bent, mean and most; *hips* how much lower they ride, mean, and *bob* their ups and downs beside the capture's;
*posture* how many degrees trunk, upper arms, forearms, thighs or shanks rise otherwise; *shoulders* how much nearer to
each other they come, beside their median; *hands* by how much the distance of near wrists is missed, mean; *sunk* how
far any joint is deeper in the ground than the capture's deepest, *inside* how far an arm is deeper in the own body;
*jump* compares each joint's greatest step with its own in the capture. Lengths are as if legs had 85 cm. The second
table compares the greatest angular acceleration of each segment with its own in the capture: 1 is as smooth.

Asked of walks, runs, strikes and dances are knees of 2 (walks 6 at most), hips of 5 mm, a bob of 0.9 to 1.1, shoulders
within 0.05, hands within 1 cm, sunk 5 mm, inside 0, jumps of 1.5 and peaks of 2; of planks and crawls a posture within
20. Written by `benchmarks/quality_tables.py`; `make quality` prints the same, the actor's own body among the bodies,
for any folder, and `adapt` reports the first three for any capture and character.

"""
SHORT = """
## What falls short

Where figures are beyond what is asked: how many of the captures, and the worst of them. Who crawls, lies down and gets
up among them has arms up to 1.8 times as long as the actor's, beside its legs: elbows go as much farther in the same
posture, and an arm that is straight over the ground, with shoulders no higher, leans or bends by 35 degrees and more.
Arms whose hands stand are not brought out of the own body.

"""
ASKED = {
    "knees mean": 2.0, "knees most": 6.0, "hips mm": 5.0, "bob": 1.1, "shoulders": 0.05, "hands cm": 1.0,
    "sunk mm": 5.0, "inside mm": 5.0, "jump": 1.5, "posture": 20.0,
}  # fmt: skip
"""What is beyond is listed as short, by title."""
PEAK = 2.0
"""The same of the peaks of all segments."""
SEEN = {
    "knees mean": ("knee_mean", degrees(1.0)), "knees most": ("knee_most", degrees(1.0)), "hips mm": ("drop", 1e3),
    "bob": ("bob", 1.0), "posture": ("posture", degrees(1.0)), "shoulders": ("shoulders", -1.0),
    "hands cm": ("hands", 1e2), "sunk mm": ("below", 1e3), "inside mm": ("inside", 1e3), "jump": ("jump", 1.0),
}  # fmt: skip
"""Titles of what an animator would see, fields of ``MotionQuality``, and their factors."""
_KEYS = ("slide_mm", "float_mm", "penetration_mm")
_FIGURES = "slide mm", "float mm", "below mm", *SEEN


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
    write_quality(qualities)
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
    first, actor = ready.capture.first_frame, ready.actor.morphology
    for body in bundled_characters().values():
        asked = AdaptRequest(
            ready.motion, body.morphology, ready.contacts, volume=body.volume, actor=actor, clears=True
        )
        standing = standing_of(asked)
        reports.append(figures(standing, asked, hold(standing, (), first), ready.source, by_frame=False))
        seen.append(motion_quality(hold(standing, ()), ready.source, ready.contacts, Ground(), first))
    found = [max(report[key] for report in reports) for key in _KEYS]
    found += [max(factor * getattr(each, name) for each in seen) for name, factor in SEEN.values()]
    found += [max(each.peaks[part] for each in seen) for part in PARTS]
    return [ready.capture.name, *("-" if isnan(figure) else f"{figure:.2f}" for figure in found)]


def write_quality(qualities: Sequence[list[str]]) -> None:
    """Both tables of all captures, and what falls short."""
    count = len(_FIGURES)
    tables = [
        table(("capture", *titles), [[row[0], *row[part]] for row in [*qualities, worst_row(qualities)]])
        for titles, part in ((_FIGURES, slice(1, count + 1)), (tuple(PARTS), slice(count + 1, None)))
    ]
    text = QUALITY + "\n## Peaks by segment\n\n".join(tables) + SHORT + short_of(qualities)
    (DOCS / "adaptation_quality.md").write_text(text, encoding="utf-8")


def worst_row(rows: Sequence[list[str]]) -> list[str]:
    """The greatest figure of each column."""
    columns = list(zip(*rows, strict=True))[1:]
    return ["**worst**", *(f"**{max(float(each) for each in column if each != '-'):.2f}**" for column in columns)]


def short_of(rows: Sequence[list[str]]) -> str:
    """A line for each figure that is beyond what is asked, of captures named as in ``rows``."""
    asked = [*(None,) * len(_KEYS), *(ASKED[title] for title in SEEN), *(PEAK,) * len(PARTS)]
    titles = [*_FIGURES, *(f"peak of {part}" for part in PARTS)]
    lines = []
    for column, (title, most) in enumerate(zip(titles, asked, strict=True), start=1):
        beyond = [(float(row[column]), row[0]) for row in rows if row[column] != "-"]
        beyond = sorted((each for each in beyond if most is not None and each[0] > most), reverse=True)
        if beyond:
            named = ", ".join(f"{name} {figure:.2f}" for figure, name in beyond[:3])
            lines.append(f"- {title} beyond {most:g}: {len(beyond)} of {len(rows)}: {named}\n")
    return "".join(lines)


def table(titles: tuple[str, ...], rows: list[list[str]]) -> str:
    """A Markdown table, figures right-aligned."""
    lines = [titles, ("---", *("---:" for _ in titles[1:])), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    sys.exit(main())
