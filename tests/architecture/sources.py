"""The project's own Python files, parsed, for tests that look at the shape of the code."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KERNELS = ROOT / "studio" / "core" / "kernels"
FOLDERS = ("studio", "resources", "examples", "benchmarks")
COMPILED = {
    "kernel",
    "allocating_kernel",
    "summing_kernel",
    "njit",
    "jit",
    "vectorize",
    "guvectorize",
    "stencil",
    "cfunc",
}

Function = ast.FunctionDef | ast.AsyncFunctionDef


def product_files() -> list[Path]:
    """Every Python file that is part of the product or makes a part of it (the tests are neither)."""
    found = [file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py")]
    return sorted([ROOT / "main.py", *found])


def test_files() -> list[Path]:
    """Every Python file of the tests."""
    return sorted((ROOT / "tests").rglob("*.py"))


@cache
def tree_of(file: Path) -> ast.Module:
    """Syntax tree of a file, parsed once for all the tests of this folder (see conftest.py)."""
    return ast.parse(file.read_text(encoding="utf-8"), str(file))


@cache
def functions_of(file: Path) -> list[Function]:
    """All functions of a file, also those in classes and in other functions."""
    return [node for node in ast.walk(tree_of(file)) if isinstance(node, Function)]


def is_compiled(function: Function) -> bool:
    """True if numba compiles it, whichever way the decorator is written."""
    calls = [node.func if isinstance(node, ast.Call) else node for node in function.decorator_list]
    return any(ast.unparse(call).rpartition(".")[2] in COMPILED for call in calls)


def place_of(file: Path, line: int = 1) -> str:
    return f"{file.relative_to(ROOT)}:{line}"
