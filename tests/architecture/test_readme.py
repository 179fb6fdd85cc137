import re

from studio.cli.main import VERBS
from tests.architecture.sources import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.compile(r"```[^`]*```|`[^`\n]+`|^ {4}[^\n]+", re.MULTILINE)
COMMANDS = re.sub(r"#[^\n]*", "", "\n".join(CODE.findall(README)))


def test_every_make_command_of_the_readme_exists():
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    named = re.findall(r"\bmake ([a-z]+)", COMMANDS)
    assert {"run", "test"} <= set(named) <= set(targets)


def test_every_verb_of_the_readme_exists():
    assert set(re.findall(r"(?:main\.py|morpho-studio) ([a-z]+)", COMMANDS)) <= set(VERBS)


def test_every_file_the_readme_points_at_exists():
    links = re.findall(r"\]\((?!https?:)([^)#]+)", README)
    assert [link for link in links if not (ROOT / link).exists()] == []
