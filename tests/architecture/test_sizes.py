import ast

from tests.architecture import sources
from tests.architecture.sources import ROOT, functions_of, place_of, product_files, tree_of

# No goals: a file, a function or a list of arguments longer than this is what a reader would split.
LONGEST_FILE = 700
LONGEST_FUNCTION, MOST_ARGUMENTS = 80, 10
LONGEST_BESIDE = 80  # benchmarks, examples and what makes resources tell their steps in one go
LONGEST_MAIN = 20


def line_count(file):
    return len(file.read_text(encoding="utf-8").splitlines())


def every_file():
    return product_files() + sources.test_files()


def is_strict(file):
    return any(file.is_relative_to(ROOT / folder) for folder in ("studio", "tests"))


def argument_count(function):
    given = function.args
    named = given.posonlyargs + given.args + given.kwonlyargs
    return len(named) + (given.vararg is not None) + (given.kwarg is not None)


def test_no_file_is_too_long_to_read_in_one_go():
    too_long = [place_of(file) for file in every_file() if line_count(file) > LONGEST_FILE]
    assert too_long == []


def test_no_function_is_too_long_to_see_at_once():
    too_long = [
        f"{place_of(file, function.lineno)} {function.name}"
        for file in every_file()
        for function in functions_of(file)
        if function.end_lineno - function.lineno + 1 > (LONGEST_FUNCTION if is_strict(file) else LONGEST_BESIDE)
    ]
    assert too_long == []


def test_no_function_of_studio_and_tests_takes_more_arguments_than_one_can_keep_in_mind():
    too_many = [
        f"{place_of(file, function.lineno)} {function.name}"
        for file in filter(is_strict, every_file())
        for function in functions_of(file)
        if argument_count(function) > MOST_ARGUMENTS
    ]
    assert too_many == []


def test_main_only_hands_over():
    assert line_count(ROOT / "main.py") <= LONGEST_MAIN


def test_every_painter_ends_whatever_happens_while_it_paints():
    """One that is left on a widget after an exception brings down the program some pictures later."""
    calls = [
        (file, node.lineno, type(parent).__name__)
        for file in product_files()
        for parent in ast.walk(tree_of(file))
        for node in ast.iter_child_nodes(parent)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "QPainter"
    ]
    assert [place_of(file, line) for file, line, parent in calls if parent != "withitem"] == []
    assert calls
