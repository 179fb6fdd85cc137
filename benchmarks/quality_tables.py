"""Faults that an animator would still clean by hand, of captures of folders on characters; the tables in docs.

    python benchmarks/quality_tables.py [FOLDER ...] [--characters NAME ...] [--write]

FOLDERs are searched for BVH files; by default those are the bundled clips, the recordings that the project makes, and
the captures beside the checkout, where they are there. Each figure is the worst of the characters named, bundled ones
or files; by default the five bundled ones and the actor's own body. ``--write`` measures round trips too, and writes
both pages of docs.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import degrees, inf, isnan, nan
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.startup.process import prepare_process  # noqa: E402

prepare_process()

from examples.keyed.recording import RECORDINGS, write_recording  # noqa: E402
from studio.cli.printing import print_table  # noqa: E402
from studio.core.errors import StudioError  # noqa: E402
from studio.core.grounds.ground import Ground  # noqa: E402
from studio.core.mesh.character import Character  # noqa: E402
from studio.core.normalized.round_trip import round_trip  # noqa: E402
from studio.core.quality.motion_quality import PART_SEGMENTS, MotionQuality, motion_quality  # noqa: E402
from studio.core.solver.adapt import solve_constraints  # noqa: E402
from studio.core.solver.grounding.grounded_motion import grounded_motion_of  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.core.solver.source import source_motion  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402
from studio.io.json_text import JsonObject  # noqa: E402
from studio.jobs.adapt_report import quality_record  # noqa: E402
from studio.jobs.adaptation import ReadyCapture, chosen_characters, ready_from_capture  # noqa: E402
from studio.resources_folder import example_captures_folder  # noqa: E402

CAPTURES = ROOT.parent / "shared" / "captures" / "bvh"
FOREIGN = [str(ROOT.parent / "shared" / "captures" / "characters" / name) for name in (
    "kaykit_barbarian_stocky.glb", "cesium_man.gltf",
)]  # fmt: skip
"""Characters that others have made."""
DOCS = ROOT / "docs"

ROUND_TRIP = """# Round trip

A capture is made independent of its actor's measures, then realised on the same actor again. The table has the
greatest difference, over every joint and every frame, of position and of rotation in the world; the aim is 0.1 mm
and 0.01 degrees. Written by `benchmarks/quality_tables.py`; `info` prints the same figures for any file.

"""
QUALITY = """# Quality of adaptation

Every bundled clip, recording that the project makes and capture beside the checkout on the five bundled characters
with detected contacts and no constraints, arms out of the own body; each figure is the worst of the five. *Slide* is
how far a standing heel, toe, hand, knee or seat moves along the ground, *float* and *below* how far it is off the
ground. *Knees* are how many degrees more than the capture's those of standing legs are bent, mean and most; *swing
knee* how many degrees straighter they are in the air, in the straightest fiftieth of the frames, *toes* how much
farther toes fold there; *face* and *palms* how many degrees these look elsewhere, at most; *hips* how much lower they
ride, mean, and *bob* their ups and downs beside the capture's; *posture* how many degrees trunk, upper arms, forearms,
thighs or shanks rise otherwise; *shoulders* how much nearer to each other they come, beside their median; *hands* by
how much the distance of near wrists is missed, mean; *sunk* how far any joint is deeper in the ground than the
capture's deepest, *inside* how far an arm is deeper in the own body, there and at rest; *jump* compares each joint's
greatest step with its own in the capture, seen from the hips on bones as long as the actor's. Other lengths are as if
legs had 85 cm. The second table compares the greatest angular acceleration of each segment with its own in the
capture: 1 is as smooth.

Asked of walks, runs, strikes and dances are knees of 2 (walks 6 at most), swing knees of 8, toes of 35, faces of 10,
palms of 20, hips of 5 mm, a bob of 0.9 to 1.1, shoulders within 0.05, hands within 1 cm, sunk 5 mm, inside 0, jumps of
1.5 and peaks of 2; of planks and crawls a posture within 20. Written by `benchmarks/quality_tables.py --write`; `make
quality` prints the same, the actor's own body among the bodies, for any folder and characters, and `adapt` reports the
first three for any capture and character.

"""
SHORT = """
## What falls short

Where figures are beyond what is asked: how many of the captures, and the worst of them. Who crawls, lies down and gets
up among them has arms up to 1.8 times as long as the actor's, beside its legs: elbows go as much farther in the same
posture, and an arm that is straight over the ground, with shoulders no higher, leans or bends by 35 degrees and more.
Arms whose hands stand are not brought out of the own body.

"""
OTHERS = """
## Characters of others

KayKit's barbarian and Cesium Man, beyond twice what the bundled characters are allowed. The barbarian's trunk is 1.9
times as long as its legs and wider than its shoulders, its arms 1.5 times, its hips lie four times as far apart as
people's, its feet are as long as its legs; Cesium Man's ankles are twice as high as usual. At rest already the
barbarian's elbows are 11 cm inside its trunk, so arms that stay out of it cannot hang: with arms that may pass through
the body its posture is beyond 40 in 19 of 70 captures instead of 55.

"""
ASKED = {
    "knees mean": 2.0, "knees most": 6.0, "hips mm": 5.0, "bob": 1.1, "shoulders": 0.05, "hands cm": 1.0,
    "sunk mm": 5.0, "inside mm": 5.0, "jump": 1.5, "posture": 20.0, "swing knee": 8.0, "toes": 35.0, "face": 10.0,
    "palms": 20.0,
}  # fmt: skip
"""Limits by title: figures beyond them are listed as short."""
PEAK = 2.0
"""The same of the peaks of all segments."""
RATIOS = "bob", "jump", *(f"peak of {part}" for part in PART_SEGMENTS)
"""Figures of which 1 is as in the capture."""
SEEN = {
    "knees mean": ("knee_mean", degrees(1.0)), "knees most": ("knee_most", degrees(1.0)),
    "swing knee": ("swing_knee", degrees(1.0)), "toes": ("toes", degrees(1.0)), "hips mm": ("drop", 1e3),
    "bob": ("bob", 1.0), "posture": ("posture", degrees(1.0)), "face": ("face", degrees(1.0)),
    "palms": ("palms", degrees(1.0)), "shoulders": ("shoulders", -1.0),
    "hands cm": ("hands", 1e2), "sunk mm": ("below", 1e3), "inside mm": ("inside", 1e3), "jump": ("jump", 1.0),
}  # fmt: skip
"""Titles of what an animator would see, fields of ``MotionQuality``, and their factors."""
_KEYS = ("slide_mm", "float_mm", "penetration_mm")
_FIGURES = "slide mm", "float mm", "below mm", *SEEN
_TITLES = *_FIGURES, *(f"peak of {part}" for part in PART_SEGMENTS)


def main() -> int:
    """Read every file once; print the tables, or write both pages."""
    asked = _arguments()
    with TemporaryDirectory(prefix="morpho-studio-recordings-") as recorded:
        return measure(asked, asked.folders or [example_captures_folder(), write_recordings(Path(recorded)), CAPTURES])


def write_recordings(folder: Path) -> Path:
    """Write the project's recordings to a folder, and return it."""
    for name in RECORDINGS:
        write_recording(name, folder / f"{name}.bvh")
    return folder


def measure(asked: argparse.Namespace, folders: Sequence[Path]) -> int:
    """Measure the files of ``folders`` in turn, and print or write the tables; returns the exit code."""
    files = [file for folder in folders for file in sorted(Path(folder).rglob("*.bvh"))]
    if not files:
        print(f"No BVH files in {', '.join(map(str, folders))}. Name a folder that has some.", file=sys.stderr)
        return 1
    try:
        characters, foreign = chosen_characters(asked.characters), chosen_characters(FOREIGN if asked.write else ())
    except StudioError as error:
        print(error, file=sys.stderr)
        return 1
    trips, qualities, others, without = [], [], [], []
    for file in files:
        capture = load_capture(file)
        if capture.body_map is None:
            without.append(file.stem)
            continue
        ready = ready_from_capture(capture)
        qualities.append(quality_row(ready, characters, own=not (asked.characters or asked.write)))
        print(*qualities[-1], flush=True)
        if asked.write:
            trips.append(trip_row(ready))
            others.append(quality_row(ready, foreign))
    if asked.write:
        write_trips(trips, len(files), without)
        write_quality(qualities, others)
    else:
        print()
        print_table(("capture", *_FIGURES, *PART_SEGMENTS), [*qualities, worst_row(qualities)])
        print("\n" + short_of(qualities))
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, metavar="FOLDER")
    parser.add_argument("--characters", nargs="+", default=[], metavar="NAME")
    parser.add_argument("--write", action="store_true")
    return parser.parse_args()


def trip_row(ready: ReadyCapture) -> list[str]:
    """Name, frames, and the worst errors of a capture's round trip."""
    error = round_trip(ready.capture, ready.motion, ready.actor)
    return [
        ready.capture.name,
        str(ready.capture.frame_count),
        f"{1000.0 * error.position:.1e}",
        f"{degrees(error.rotation):.1e}",
    ]


def quality_row(ready: ReadyCapture, characters: Mapping[str, Character], *, own: bool = False) -> list[str]:
    """Name, and for each figure the worst over the ``characters``, and the actor's ``own`` body."""
    reports: list[JsonObject] = []
    seen: list[MotionQuality] = []
    first, actor = ready.capture.first_frame, ready.actor.morphology
    source = source_motion(ready.motion, ready.actor)
    on_actor = AdaptRequest(ready.motion, actor, ready.contacts, actor=actor, clears=True)
    requests = [on_actor] if own else []
    requests += [replace(on_actor, morphology=each.morphology, volume=each.volume) for each in characters.values()]
    for asked in requests:
        standing = grounded_motion_of(asked)
        reports.append(
            quality_record(standing, asked, solve_constraints(standing, (), first), ready.source_peaks, by_frame=False)
        )
        seen.append(motion_quality(solve_constraints(standing, ()), source, ready.contacts, Ground(), first))
    found = [max(report[key] for report in reports) for key in _KEYS]
    found += [max(factor * getattr(each, name) for each in seen) for name, factor in SEEN.values()]
    found += [max(each.peaks[part] for each in seen) for part in PART_SEGMENTS]
    return [ready.capture.name, *("-" if isnan(figure) else f"{figure:.2f}" for figure in found)]


def write_trips(trips: Sequence[list[str]], files: int, without: Sequence[str]) -> None:
    """The table of round trips of all captures; how many ``files`` there were, and which are ``without`` a body."""
    summary = f"{len(trips)} of {files} files hold a human body; no body: {', '.join(without) or 'none'}.\n\n"
    worst = [f"**worst of {len(trips)}**", "", *(f"**{max(float(row[k]) for row in trips):.1e}**" for k in (2, 3))]
    titles = ("capture", "frames", "position mm", "rotation degrees")
    (DOCS / "round_trip.md").write_text(ROUND_TRIP + summary + table(titles, [*trips, worst]), encoding="utf-8")


def write_quality(qualities: Sequence[list[str]], others: Sequence[list[str]]) -> None:
    """Both tables of all captures, and what falls short, on the bundled characters and on those of others."""
    count = len(_FIGURES)
    tables = [
        table(("capture", *titles), [[row[0], *row[part]] for row in [*qualities, worst_row(qualities)]])
        for titles, part in ((_FIGURES, slice(1, count + 1)), (tuple(PART_SEGMENTS), slice(count + 1, None)))
    ]
    text = QUALITY + "\n## Peaks by segment\n\n".join(tables) + SHORT + short_of(qualities)
    text += OTHERS + short_of(others, 2.0)
    (DOCS / "adaptation_quality.md").write_text(text, encoding="utf-8")


def worst_row(rows: Sequence[list[str]]) -> list[str]:
    """The greatest figure of each column."""
    columns = list(zip(*rows, strict=True))[1:]
    most = (max((float(each) for each in column if each != "-"), default=nan) for column in columns)
    return ["**worst**", *(f"**{each:.2f}**" for each in most)]


def short_of(rows: Sequence[list[str]], tolerances: float = 1.0) -> str:
    """A line for each figure that is beyond what is asked, ``tolerances`` times, of captures named as in ``rows``."""
    lines = []
    for column, title in enumerate(_TITLES, start=1):
        most = PEAK if title.startswith("peak") else ASKED.get(title, inf)
        most = 1.0 + tolerances * (most - 1.0) if title in RATIOS else tolerances * most
        beyond = [(float(row[column]), row[0]) for row in rows if row[column] != "-"]
        beyond = sorted((each for each in beyond if each[0] > most), reverse=True)
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
