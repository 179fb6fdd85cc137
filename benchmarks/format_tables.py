"""Measure what is lost by writing and reading each format, over a folder of captures, and write the tables in docs.

    python benchmarks/format_tables.py [FOLDER]

FOLDER is searched for BVH files; by default the captures beside the checkout. USD needs usd-core.
"""

import sys
from dataclasses import dataclass
from math import degrees
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studio.startup.process import prepare_process  # noqa: E402

prepare_process()

from benchmarks.read_back import places_in  # noqa: E402
from studio.core.body.kinematics import joint_world  # noqa: E402
from studio.core.rotations import angle_between, from_matrix  # noqa: E402
from studio.core.solver.adapt import adapt  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.io.export import Take, take_of_actor, take_of_capture, write_take  # noqa: E402
from studio.io.gltf.vrma_writer import humanoid_capture  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402
from studio.jobs.adaptation import ReadyCapture, ready_from_capture  # noqa: E402

CAPTURES = ROOT.parent / "shared" / "captures" / "bvh"
DOCS = ROOT / "docs"
SUFFIXES = (".bvh", ".fbx", ".s4d", ".glb", ".vrma", ".usd", ".c3d", ".csv", ".npz")

TEXT = """# Round trip of every format

A capture is adapted to its own actor's body with its contacts, written, and read again. The table has the greatest
distance in millimetres, over every joint and every frame, between what was written and what was read; the aim is 0.1
mm. FBX is read by ufbx, USD by usd-core, CSV and NPZ as a spreadsheet or NumPy would. A VRM animation (VRMA) has the
joints of a humanoid alone, with bones of constant length: it is compared with these. The last columns are about the
capture itself, not adapted, as S4D: greatest turn of any joint in degrees (aim 0.01), and size of the file over that
of the BVH (aim below 0.5). Written by `benchmarks/format_tables.py`.

"""


@dataclass(frozen=True)
class Row:
    """The figures of one capture."""

    name: str
    frames: int
    errors: tuple[float, ...]
    """Millimetres by ``SUFFIXES``."""
    degrees: float
    size: float


def main() -> int:
    """Write every capture in every format, read it, write the table."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else CAPTURES
    files = sorted(folder.rglob("*.bvh"))
    if not files:
        print(f"No BVH files in {folder}. Name a folder that has some.", file=sys.stderr)
        return 1
    rows = []
    for file in files:
        capture = load_capture(file)
        if capture.body_map is not None:
            rows.append(row_of(file, ready_from_capture(capture)))
            print(rows[-1].name, *(f"{error:.5f}" for error in rows[-1].errors), f"{rows[-1].size:.2f}", flush=True)
    DOCS.mkdir(exist_ok=True)
    (DOCS / "format_round_trip.md").write_text(TEXT + table(rows), encoding="utf-8")
    return 0


def row_of(file: Path, ready: ReadyCapture) -> Row:
    """All figures of one capture."""
    request = AdaptRequest(ready.motion, ready.actor.morphology, ready.contacts)
    adapted = adapt(request, ready.capture.first_frame)
    take = take_of_actor(adapted, ready.actor, ready.capture, request)
    with TemporaryDirectory() as folder:
        errors = tuple(lost_millimetres(take, Path(folder) / f"take{suffix}") for suffix in SUFFIXES)
        stored = Path(folder) / "capture.s4d"
        write_take(take_of_capture(ready.capture), stored)
        back = load_capture(stored)
        size = stored.stat().st_size / file.stat().st_size
    turns = [joint_world(each.skeleton, each.poses)[1] for each in (ready.capture, back)]
    turned = degrees(angle_between(*map(from_matrix, turns)).max())
    return Row(ready.capture.name, ready.capture.frame_count, errors, turned, size)


def lost_millimetres(take: Take, path: Path) -> float:
    """Greatest distance between a joint as it was written to ``path`` and as it is read from there."""
    write_take(take, path)
    capture = humanoid_capture(take)[0] if path.suffix == ".vrma" else take.capture
    skeleton = capture.skeleton
    there, back = joint_world(skeleton, capture.poses)[0], places_in(path)
    joints = [joint for joint, name in enumerate(skeleton.names) if name in back]
    moving = np.count_nonzero(~skeleton.end_sites)
    if len(joints) < moving:
        raise SystemExit(f"{path.name}: {moving - len(joints)} joints of {take.name} are not in it.")
    distances = [np.linalg.norm(back[skeleton.names[joint]] - there[:, joint], axis=1).max() for joint in joints]
    return 1000.0 * float(max(distances))


def table(rows: list[Row]) -> str:
    """The figures as Markdown, the worst of each column last."""
    titles = ("capture", "frames", *(suffix[1:].upper() for suffix in SUFFIXES), "S4D degrees", "S4D size")
    lines = [titles, ("---", *("---:" for _ in titles[1:]))]
    lines += [(row.name, str(row.frames), *_figures(row.errors, row.degrees, row.size)) for row in rows]
    worst = [max(row.errors[index] for row in rows) for index in range(len(SUFFIXES))]
    figures = _figures(worst, max(row.degrees for row in rows), max(row.size for row in rows))
    lines.append((f"**worst of {len(rows)}**", "", *(f"**{figure}**" for figure in figures)))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _figures(errors: list[float] | tuple[float, ...], turned: float, size: float) -> list[str]:
    return [*(f"{error:.1e}" for error in errors), f"{turned:.1e}", f"{size:.2f}"]


if __name__ == "__main__":
    sys.exit(main())
