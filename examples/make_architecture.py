"""Draw the packages in docs/architecture.md from the import contracts: python examples/make_architecture.py."""

import ast
import tomllib
from itertools import takewhile
from pathlib import Path
from textwrap import wrap

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"
BEGIN, END = "<!-- drawn by examples/make_architecture.py -->\n", "<!-- end of the drawing -->\n"
WIDTH, NAMES = 100, 13


def drawing() -> str:
    """Packages from the top with the first sentence of each; a line stands between those that know each other."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = {each["containers"][0]: each["layers"] for each in contracts if each["type"] == "layers"}
    [qt_free] = (set(each["source_modules"]) for each in contracts if "PySide6" in each.get("forbidden_modules", ()))
    above = takewhile(lambda layer: not qt_free.issuperset(_packages("studio", layer)), layers["studio"])
    floors, rooms = ([_rows(owner, layer) for layer in layers[owner]] for owner in ("studio", "studio.core"))
    qt_line = " the Qt line: nothing below knows a toolkit ".center(WIDTH, "=")
    highest = len(list(above))
    drawn = [*_ruled(floors[:highest]), qt_line, *_ruled(floors[highest:])]
    return "\n".join(["```", *drawn, "", "within core:", "", *_ruled(rooms), "```", ""])


def _packages(owner: str, layer: str) -> list[str]:
    return [f"{owner}.{name.strip()}" for name in layer.split("|")]


def _rows(owner: str, layer: str) -> list[str]:
    """Lines of the packages of one layer, which never import each other."""
    rows = []
    for package in _packages(owner, layer):
        source = (ROOT / package.replace(".", "/") / "__init__.py").read_text(encoding="utf-8")
        first, *others = wrap((ast.get_docstring(ast.parse(source)) or "").splitlines()[0], WIDTH - NAMES)
        rows += [f"{package.rpartition('.')[2]:<{NAMES}}{first}", *(" " * NAMES + line for line in others)]
    return rows


def _ruled(layers: list[list[str]]) -> list[str]:
    """Lines of layers with a rule between two of them."""
    first, *others = layers
    return first + [line for layer in others for line in ("-" * WIDTH, *layer)]


def main() -> None:
    """Replace the drawing in the page."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    PAGE.write_text(before + BEGIN + drawing() + END + rest.partition(END)[2], encoding="utf-8")


if __name__ == "__main__":
    main()
