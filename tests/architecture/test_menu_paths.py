"""A menu path that a message names is in the table of actions."""

import ast
import re
from pathlib import Path

from studio.app.actions import ACTIONS
from tests.architecture.sources import place_of, product_files, tree_of

PATH = re.compile(r"\b([A-Z][a-z]+) > ([A-Z][^.,;:()'\"{]*)")


def paths_in(file: Path) -> list[tuple[str, str, str]]:
    """File and line, menu and rest of each path in the strings of a file; docstrings are none of its messages."""
    tree = tree_of(file)
    docstrings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    strings = (node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return [
        (place_of(file, node.lineno), menu, rest)
        for node in strings
        if node not in docstrings
        for menu, rest in PATH.findall(node.value)
    ]


def test_every_menu_path_of_a_message_is_in_the_table_of_actions() -> None:
    labels = [(action.menu, action.text.rstrip("…")) for action in ACTIONS]
    found = [path for file in product_files() if "studio" in file.parts for path in paths_in(file)]
    lost = [
        each
        for each in found
        if not any(
            each[1] == menu and (each[2].startswith(label) or label.startswith(each[2])) for menu, label in labels
        )
    ]
    assert lost == []
    assert len(found) >= 8
