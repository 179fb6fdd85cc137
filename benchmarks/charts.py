"""The growth of the cost as a picture: points as measured, the fitted line, its slope."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.growth import Growth

INK, LINE = "#2F6FB3", "#9AA4AE"
mpl.rcParams["svg.hashsalt"] = "morpho-studio"  # the same figures give the same file
mpl.rcParams["svg.fonttype"] = "none"  # letters stay letters: a third of the size


def draw_growth(constraints: Growth, characters: Growth, stage: Growth, live: Growth, file: Path) -> None:
    """All plots side by side, as SVG."""
    figure = Figure(figsize=(13.0, 3.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    _draw(left, constraints, 1.0, "constraints on one character", "µs a frame")
    _draw(middle, characters, 1e-3, "characters of the worst kind", "ms for a frame of all")
    _draw(right, live, 1e-3, "performers of a stage (upper line: played live)", "ms for a frame of all")
    _draw(right, stage, 1e-3, "performers of a stage (upper line: played live)", "ms for a frame of all")
    for axes in (middle, right):
        axes.set_ylim(top=max(axes.get_ylim()[1], 1.2e3 / 30.0))
        axes.axhline(1e3 / 30.0, color="#C8553D", linewidth=1.0, linestyle="--")
        axes.text(0.0, 1e3 / 30.0, " one core at 30 Hz", color="#C8553D", fontsize=8, va="bottom")
    figure.savefig(file, format="svg", metadata={"Date": None})


def _draw(axes: Axes, growth: Growth, unit: float, what: str, cost: str) -> None:
    ends = [0, growth.counts[-1]]
    if growth.least != growth.most:
        least, most = ([unit * each for each in edge] for edge in (growth.least, growth.most))
        axes.fill_between(growth.counts, least, most, color=INK, alpha=0.15, linewidth=0.0, label="least and most")
    label = f"{growth.slope:.1f} µs each, R² {growth.fit:.3f}"
    axes.plot(ends, [unit * (growth.fixed + growth.slope * end) for end in ends], color=LINE, label=label)
    axes.plot(growth.counts, [unit * each for each in growth.costs], "o", color=INK, markersize=4)
    axes.set(xlabel=what, ylabel=cost, xlim=(0, None), ylim=(0, None))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper left")
