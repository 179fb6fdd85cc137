"""Tables out of what was measured, and into the documents: nothing in them is written by hand."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.growth import Growth
from benchmarks.stages import beyond_linear

Record = dict[str, Any]

BEGIN, END = "<!-- measured: {} -->", "<!-- end of what was measured -->"
PAPER_CHARACTERS, AIM_CHARACTERS = 22, 2200
AIMS = "aims: 0.2 mm, 0.2 mm, 1 mm, 15 mm, 3"
"""Of reachable targets, slide, balance, excess, acceleration."""

HEADER = """# Measured speed and quality

Written by `make bench`; nothing here is written by hand. [evidence.md](evidence.md) explains what is measured.
[window.md](window.md) has the window under a hand: how far the bodies are behind it, and what pictures cost.

"""
HOW = """Whole clips on one character, conversion included, in microseconds a frame; {captures}:
{clips}.
What counts is the processor time of the process on all its threads: waiting on a busy machine is not counted, nor is
help from a second core. All jobs take turns in each of {rounds} rounds; a clip's figure is the median of its rounds,
the table's the median of the clips. Quality is the worst of all clips on two characters, an adult and a child. Paper:
Pronost et al. 2009 and Kulpa et al. 2005, on the computers of their time.

Machine: {machine}; load while measuring {load:.1f}.
"""


def tables(record: Record) -> str:
    """All tables, in Markdown."""
    clips = ", ".join(f"{name} ({count} frames)" for name, count in record["clips"].items())
    how = HOW.format(**{**record, "clips": clips})
    return "\n".join(
        [
            how,
            *("## Time", "", times(record)),
            *("## Quality", "", qualities(record)),
            *("## Growth", "", growth(record)),
            *("## Peers on the same tasks", "", peers(record)),
            *("## Start", "", start(record)),
        ]
    )


def times(record: Record) -> str:
    """Microseconds a frame beside papers, aims and the least that it could take."""
    least = record["rows"][0]["median"]
    rows = [
        [row["name"], f"{row['median']:.2f}", f"{row['best']:.2f}", number(row["paper"], "{:.0f}"), number(row["aim"]),
         "-" if row["aim"] is None else f"{row['median'] / row['aim']:.1f}", f"{row['median'] / least:.0f}"]
        for row in record["rows"]
    ]  # fmt: skip
    crowd = 1e6 / 30.0 / record["rows"][-1]["median"]
    per_core = ["characters of that worst kind at 30 Hz, one core", f"**{crowd:,.0f}**", "", str(PAPER_CHARACTERS)]
    rows.append([*per_core, f"{AIM_CHARACTERS:,}", f"{AIM_CHARACTERS / crowd:.1f}", ""])
    titles = ("work", "µs, median", "best", "paper", "aim", "time / aim", "x forward kinematics")
    return table(titles, rows)


def qualities(record: Record) -> str:
    """The worst of each task."""
    rows = []
    for row in record["rows"]:
        if found := row["quality"]:
            excess = "-" if found["excess"] is None else "{:.1f} / {:.1f}".format(*found["excess"])
            rows.append(
                [
                    row["name"],
                    *(number(found[key], "{:.3f}") for key in ("reachable", "slide", "balance")),
                    excess,
                    *(number(found[key], "{:.1f}") for key in ("acceleration", "segment_acceleration")),
                ]
            )
    titles = (
        "work", "reachable missed, mm", "feet slide, mm", "balance off, mm", "beyond optimum, mm (median / most)",
        "peak acceleration / source", "worst segment / itself",
    )  # fmt: skip
    return table(titles, rows) + f"\n({AIMS}.)\n"


def growth(record: Record) -> str:
    """The fitted lines; the picture shows the points."""
    one, many = record["constraints"], record["characters"]
    stage, live = Growth(**record["stage"]), Growth(**record["live"])
    median, most_often, most = record["fight"]
    return (
        "![Cost against constraints and characters](pictures/growth.svg)\n\n"
        f"Constraints, 1 to {one['counts'][-1]} of every kind in four priorities, means over orders in which they are "
        f"added: {one['costs'][0]:.1f} µs for the first ({one['least'][0]:.1f} to {one['most'][0]:.1f}), "
        f"{one['costs'][-1]:.1f} µs for all; fitted {one['slope']:.1f} µs each (R² {one['fit']:.3f}).\n"
        f"Characters of the worst kind, 1 to {many['counts'][-1]:,}: fitted {many['slope']:.1f} µs each "
        f"(R² {many['fit']:.4f}), {1e6 / 30.0 / many['slope']:,.0f} on one core at 30 Hz.\n"
        f"Performers of a stage, 1 to {stage.counts[-1]:,}, each with a row of two clips that blend and two "
        f"constraints, all that is done before solving included: fitted {stage.slope:.1f} µs each a frame "
        f"(R² {stage.fit:.4f}); one of {stage.counts[-1]:,} costs {beyond_linear(stage):.2f} times one of ten.\n"
        f"A step of a stage that plays live, with the same performers: fitted {live.slope:.1f} µs each "
        f"(R² {live.fit:.4f}); one of {live.counts[-1]:,} costs {beyond_linear(live):.2f} times one of ten.\n"
        f"A step of the fight training, eight fighters with all that they ask of each other: {median:.1f} ms in the "
        f"median, {most_often:.1f} in 95 of 100, {most:.1f} at most; 16.7 are 60 Hz.\n"
    )


def peers(record: Record) -> str:
    """Time and quality of other solvers, from the same poses; those that are not installed by name."""
    absent = [name for name, answers in record["peers"].items() if answers is None]
    keys = "miss", "slide", "balance"
    rows = [
        [
            row["name"],
            name,
            f"{found['microseconds']:,.{0 if found['microseconds'] > 99.5 else 1}f}",
            *("{:.2f} / {:.1f}".format(*found[key]) for key in keys),
        ]
        for row in record["rows"]
        for name, answers in record["peers"].items()
        if answers and (found := answers.get(row["name"]))
    ]
    titles = ("work", "who", "µs a frame", "missed, mm (median / most)", "feet slide, mm", "balance off, mm")
    notes = "; ".join(f"{name}: {note}" for name, note in record["peer_notes"].items() if name not in absent)
    told = f"{notes}. Each frame from its own pose, without limits of joints. " if notes else ""
    missing = f"Not installed when this was measured: {', '.join(absent)}. " if absent else ""
    words = f"On {record['peer_clip']}. {told}{missing}".rstrip()
    return f"{table(titles, rows)}\n{words}\n"


def start(record: Record) -> str:
    """Kernels, cold and warm."""
    found = record["start_up"]
    return (
        f"All kernels compiled into an empty cache, by two processes: {found['cold_by_the_clock']:.0f} s by the clock "
        f"(aim 40), {found['cold']:.0f} s of processor time.\n"
        f"First call from a warm cache: {found['warm']:.2f} s ({found['warm_by_the_clock']:.2f} s by the clock; aim "
        f"0.5), after {found['imports']:.1f} s of imports.\n"
    )


PARTS: dict[str, Callable[[Record], str]] = {
    "times": times,
    "quality": qualities,
    "growth": growth,
    "peers": peers,
    "start": start,
}
"""Text of ``evidence.md`` between its marks."""


def fill(record: Record, docs: Path) -> None:
    """Write ``benchmark.md``, and the marked places of ``evidence.md``."""
    (docs / "benchmark.md").write_text(HEADER + tables(record), encoding="utf-8")
    text = (docs / "evidence.md").read_text(encoding="utf-8")
    for name, make in PARTS.items():
        text = replaced(text, name, make(record))
    (docs / "evidence.md").write_text(text, encoding="utf-8")


def replaced(text: str, name: str, new: str) -> str:
    """``text`` with what stands between a begin mark and the next end mark replaced."""
    before, mark, rest = text.partition(BEGIN.format(name))
    if not mark:
        return text
    return f"{before}{mark}\n{new}{END}{rest.partition(END)[2]}"


def table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table, figures right-aligned."""
    lines = [titles, ("---", *("---:" for _ in titles[1:])), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def number(value: float | None, form: str = "{:.1f}") -> str:
    """A figure, or a dash where there is none."""
    return "-" if value is None else form.format(value)
