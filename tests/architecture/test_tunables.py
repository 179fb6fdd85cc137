"""Every number of the engine that somebody chose says what it is."""

import ast
from collections.abc import Iterator

from tests.architecture.sources import ROOT, place_of, tree_of

ROOMS = ("studio/core/kernels", "studio/core/solver")


def tunables() -> Iterator[tuple[str, bool]]:
    """Names of module-level numbers that are chosen, and whether a docstring or a comment says what they are."""
    for room in ROOMS:
        for file in sorted((ROOT / room).rglob("*.py")):
            lines = file.read_text(encoding="utf-8").splitlines()
            body = tree_of(file).body
            for index, node in enumerate(body):
                if isinstance(node, ast.Assign):
                    told = is_told(body, index, lines)
                    for name in chosen_names(node):
                        yield f"{place_of(file, node.lineno)} {name}", told


def chosen_names(node: ast.Assign) -> list[str]:
    """Of one name for one value, or several for several: those whose value is not made of other constants."""
    target, value = node.targets[0], node.value
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        pairs = zip(target.elts, value.elts, strict=True)
    else:
        pairs = zip([target], [value], strict=True)
    return [ast.unparse(name) for name, part in pairs if is_chosen(part)]


def is_chosen(value: ast.AST) -> bool:
    """Fractions as they are written, alone or in a table; a part of another constant follows from that, and a record
    says what it is. The origin, and a turn by nothing, nobody chose.
    """
    if isinstance(value, ast.Constant):
        return isinstance(value.value, float)
    if isinstance(value, ast.Tuple) and all(ast.unparse(part) in ("0.0", "1.0") for part in value.elts):
        return False
    named = {part.id for part in ast.walk(value) if isinstance(part, ast.Name)}
    if isinstance(value, ast.BinOp) and named - {"math", "np"}:
        return False
    if isinstance(value, ast.Call) and ast.unparse(value.func).split(".")[0] not in ("math", "np", "dict"):
        return False
    return any(is_chosen(part) for part in ast.iter_child_nodes(value))


def is_told(body: list[ast.stmt], index: int, lines: list[str]) -> bool:
    """By a comment on its line, or a docstring after the run of assignments that it stands in."""
    if "#" in lines[body[index].lineno - 1]:
        return True
    while index < len(body) and isinstance(body[index], ast.Assign):
        index += 1
    after = body[index] if index < len(body) else None
    return isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)


def test_every_number_of_the_solver_says_what_it_is() -> None:
    assert [name for name, told in tunables() if not told] == []
