"""Each dependency that is declared is imported, and what is imported is declared."""

import ast
import re
import sys
import tomllib
from functools import cache
from importlib.metadata import packages_distributions

from tests.architecture import sources
from tests.architecture.sources import ROOT, product_files, tree_of

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BROUGHT_ALONG = {"llvmlite": "numba", "shiboken6": "pyside6-essentials"}
"""Packages that are a part of another one, whose version they follow."""
IMPORT_NAMES = {"pin": "pinocchio", "faiss-cpu": "faiss"}
"""Names under which packages are imported that may not be installed here."""
TOOLS = {
    "ruff": ("Makefile", "bin/ruff check"),
    "mypy": ("Makefile", "bin/mypy"),
    "import-linter": ("Makefile", "bin/lint-imports"),
    "build": ("tests/architecture/test_wheel.py", '"-m", "build"'),
    "hatchling": ("pyproject.toml", 'build-backend = "hatchling.build"'),
    "pytest-qt": ("pyproject.toml", "qt_api"),
    "pytest-timeout": ("pyproject.toml", "timeout ="),
    "scipy-stubs": ("pyproject.toml", "[tool.mypy]"),
    "daqp": ("benchmarks/peers/mink_qp.py", '"daqp"'),
}
"""Dependencies run or found by name instead of imported: the file and the words that do so."""


def distribution_names(requirements):
    """Lower-case names of the distributions in requirements such as ``numpy>=2.0``."""
    return {re.match(r"[\w.-]+", requirement)[0].lower() for requirement in requirements}


def imported(files):
    """Names of the packages from outside that files import."""
    return set().union(*map(imported_by, files))


@cache
def imported_by(file):
    """Names of the packages from outside that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(tree_of(file)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(node.module)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "importorskip":
            found.add(ast.literal_eval(node.args[0]))
    return {name.split(".")[0] for name in found} - sys.stdlib_module_names


@cache
def installed():
    """Distributions of each package that is installed; they are found by reading the lists of all files."""
    return packages_distributions()


def distributions_of(packages):
    """The distribution of each package, or the package's own name where it is not installed."""
    known = installed()
    by_import = {name: distribution for distribution, name in IMPORT_NAMES.items()}
    return {
        BROUGHT_ALONG.get(name, by_import.get(name, known.get(name, [name])[0].lower().replace("_", "-")))
        for name in packages
    }


def of_studio():
    return distributions_of(imported(file for file in product_files() if file.is_relative_to(ROOT / "studio")))


def test_every_dependency_at_run_time_is_imported_by_the_studio():
    assert distribution_names(PROJECT["dependencies"]) - of_studio() == set()


def test_what_the_studio_imports_is_a_dependency_or_an_extra_of_users():
    extras = PROJECT["optional-dependencies"]
    declared = distribution_names(PROJECT["dependencies"])
    for_users = declared.union(*(distribution_names(extras[name]) for name in ("batch", "fbx", "sound", "usd")))
    assert of_studio() - for_users == {"studio"}


def test_every_package_of_developers_is_imported_or_a_tool():
    used = distributions_of(imported([*product_files(), *sources.test_files()])) | TOOLS.keys()
    extras = PROJECT["optional-dependencies"]
    assert distribution_names([*extras["dev"], *extras["peers"]]) - used == set()


def test_every_tool_is_named_where_it_is_run():
    missing = {name for name, (file, words) in TOOLS.items() if words not in (ROOT / file).read_text(encoding="utf-8")}
    assert missing == set()
