import re

import pytest

from studio.app.actions import ACTIONS
from studio.cli.main import VERBS
from tests.architecture.sources import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8")
PAGES = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")])
CODE = re.compile(r"```[^`]*```|`[^`\n]+`|^ {4}[^\n]+", re.MULTILINE)
COMMANDS = re.sub(r"#[^\n]*", "", "\n".join(CODE.findall(README)))
PICTURES = 6_000_000
FILM = 3_000_000


def links_of(page):
    return re.findall(r"\]\((?!https?:)([^)\s]+)\)", page.read_text(encoding="utf-8"))


def anchors_of(page):
    heads = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_every_make_command_of_the_readme_exists():
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    named = re.findall(r"\bmake ([a-z]+)", COMMANDS)
    assert {"run", "test"} <= set(named) <= set(targets)


def test_every_verb_of_the_readme_exists():
    assert set(re.findall(r"(?:main\.py|morpho-studio) ([a-z]+)", COMMANDS)) <= set(VERBS)


def test_every_file_that_a_command_of_the_readme_reads_exists():
    named = re.findall(r"examples/\S+\.bvh", COMMANDS)
    assert named
    assert [name for name in named if not (ROOT / name).is_file()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file_and_a_head_that_exist(page):
    for link in links_of(page):
        name, _, anchor = link.partition("#")
        goal = page.parent / name if name else page
        assert goal.exists(), link
        assert not anchor or anchor in anchors_of(goal), link


def test_every_page_of_the_docs_can_be_found_from_the_readme():
    named = {(page.parent / link.partition("#")[0]).resolve() for page in PAGES for link in links_of(page)}
    assert [page.name for page in PAGES if page.name != "README.md" and page not in named] == []


def test_every_picture_is_shown_somewhere_and_all_together_are_small():
    pictures = list((ROOT / "docs" / "pictures").iterdir())
    shown = {(page.parent / link).resolve() for page in PAGES for link in links_of(page)}
    assert [picture.name for picture in pictures if picture.resolve() not in shown] == []
    assert sum(picture.stat().st_size for picture in pictures) < PICTURES
    assert [each.name for each in pictures if each.suffix == ".gif" and each.stat().st_size > FILM] == []


def test_the_guide_names_every_shortcut():
    table = GUIDE[GUIDE.index("## Shortcuts") :]
    keys = {keys for action in ACTIONS for keys in action.shortcuts}
    assert sorted(each for each in keys if not re.search(rf"(?<![+\w]){re.escape(each)}(?![+\w])", table)) == []
