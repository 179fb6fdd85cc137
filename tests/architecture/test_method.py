"""The method has no gaps, and what the code cites of it is there."""

import re

import pytest

from tests.architecture.sources import ROOT, place_of, product_files

PAGES = {file: file.read_text(encoding="utf-8") for file in sorted((ROOT / "docs" / "method").glob("*.md"))}
METHOD = "\n".join(PAGES.values())
SECTIONS = set(re.findall(r"^# (\d+)\.", METHOD, re.MULTILINE))
EQUATIONS = re.findall(r"  \((\d+a?)\)$", METHOD, re.MULTILINE)
"""Numbers of the equations; one that was put between two others has the letter a behind the number of the first."""


def test_equations_and_pages_are_numbered_without_a_gap_each_once():
    assert len(set(EQUATIONS)) == len(EQUATIONS)
    own = {number for number in EQUATIONS if number.isdigit()}
    assert own == {*map(str, range(1, len(own) + 1))}
    assert {number.removesuffix("a") for number in EQUATIONS} == own
    assert {*map(str, range(1, len(PAGES) + 1))} == SECTIONS


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_page_has_an_equation_and_a_figure_and_is_in_the_index(page):
    index = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    assert re.search(r"  \(\d+a?\)$", PAGES[page], re.MULTILINE)
    assert f"(method/{page.name})" in index
    figures = re.findall(r"!\[.+\]\((.+)\)", PAGES[page])
    assert figures
    assert all((page.parent / figure).is_file() for figure in figures)


def test_every_section_and_equation_that_is_cited_is_there():
    lost = []
    for file in [*product_files(), *(ROOT / "tests").rglob("*.py")]:
        text = re.sub(r"\s+", " ", file.read_text(encoding="utf-8"))
        for section, equation in re.findall(r"METHOD(?:,)? (?:(\d+)(?:\.\d)?|\((\d+a?)\))", text):
            if (section and section not in SECTIONS) or (equation and equation not in EQUATIONS):
                lost.append(f"{place_of(file)} cites {section or equation}")
    assert lost == []


def test_every_module_that_the_method_names_is_there():
    core = ROOT / "studio" / "core"
    named = {name for name in re.findall(r"`([a-z_]+(?:\.[a-z_]+)+)`", METHOD) if (core / name.split(".")[0]).is_dir()}
    found = {name for name in named if exists(core, name)}
    assert sorted(named - found) == []


def exists(core, name):
    """A package, a module, or something defined in one."""
    parts = name.split(".")
    if (core.joinpath(*parts)).is_dir() or core.joinpath(*parts).with_suffix(".py").is_file():
        return True
    module = core.joinpath(*parts[:-1]).with_suffix(".py")
    return module.is_file() and f"def {parts[-1]}(" in module.read_text(encoding="utf-8")
