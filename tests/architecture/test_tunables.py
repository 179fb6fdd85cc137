"""Every number that somebody chose says what it is: constants of the solver and its kernels have a docstring."""

import ast

from tests.architecture.sources import ROOT, place_of

ROOMS = ("studio/core/kernels", "studio/core/solver")


def tunables():
    """Module-level constants with a fraction in them, and whether a docstring or a comment says what they are."""
    for room in ROOMS:
        for file in sorted((ROOT / room).rglob("*.py")):
            lines = file.read_text(encoding="utf-8").splitlines()
            body = ast.parse("\n".join(lines)).body
            for place, node in enumerate(body):
                if isinstance(node, ast.Assign) and is_chosen(node.value):
                    yield f"{place_of(file, node.lineno)} {ast.unparse(node.targets[0])}", is_told(body, place, lines)


def is_chosen(value):
    """Fractions as they are written, alone or several."""
    parts = value.elts if isinstance(value, ast.Tuple) else [value]
    return any(isinstance(part, ast.Constant) and isinstance(part.value, float) for part in parts)


def is_told(body, place, lines):
    """By a comment on its line, or a docstring after the run of assignments that it stands in."""
    if "#" in lines[body[place].lineno - 1]:
        return True
    while place < len(body) and isinstance(body[place], ast.Assign):
        place += 1
    return place < len(body) and isinstance(body[place], ast.Expr) and isinstance(body[place].value, ast.Constant)


def test_every_number_of_the_solver_says_what_it_is():
    assert [name for name, told in tunables() if not told] == []
