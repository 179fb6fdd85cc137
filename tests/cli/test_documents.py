"""Every command, record and script of the documents does what it says, typed as it stands there."""

import json
import os
import re
import shlex
from argparse import ArgumentParser
from pathlib import Path

import pytest

from studio.cli.arguments import ADD_ARGUMENTS
from studio.cli.main import VERBS, main
from studio.document.clipboard import paste_json
from studio.document.document import Document
from studio.io.markers.maps import read_map
from studio.io.registry import known_formats
from studio.jobs.bundled_scenes import BUNDLED_SCENES
from studio.resources_folder import bundled_strikes_folder
from tests.architecture.sources import ROOT
from tests.builders import make_project

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
HEADLESS = (ROOT / "docs" / "headless.md").read_text(encoding="utf-8")
FENCED = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^(?: {4})?(?:python main\.py|morpho-studio) (.+?)(?: +#.*)?$", re.MULTILINE)
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
SHORTENED = {"live": ["--seconds", "0.2", "--fast"], "render": ["--size", "160x90", "--film-rate", "2"]}
"""Options added to commands that play or draw for minutes; the last of equal options counts."""
ALWAYS = {"--help", "--version"}


def commands(page):
    """The words of every command of a page, in order."""
    return [shlex.split(found) for found in COMMAND.findall(page.read_text(encoding="utf-8"))]


def blocks(page, language):
    """The fenced blocks of a page in a language."""
    return [text for kind, text in FENCED.findall(page.read_text(encoding="utf-8")) if kind == language]


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """A folder with the examples, the constraints of the document, and a home of its own."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    [constraints] = blocks(ROOT / "docs" / "headless.md", "json")
    (tmp_path / "targets.json").write_text(constraints, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "home" / "data"))
    return tmp_path


@pytest.mark.timeout(600)
@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)], ids=lambda page: page.name)
def test_every_command_of_a_page_works_as_it_stands_there(page, scratch, capsys):
    for verb, *words in commands(page):
        if verb == "COMMAND":
            continue
        typed = [verb, *map(os.path.expanduser, words), *SHORTENED.get(verb, [])]
        assert main(typed) == 0, f"{shlex.join(typed)}: {capsys.readouterr().err}"
    for script in blocks(page, "python"):
        exec(compile(script, page.name, "exec"), {})


def test_files_that_headless_says_are_written_are_written(scratch, capsys):
    [adapt] = [
        words
        for words in commands(ROOT / "docs" / "headless.md")
        if words[:2] == ["adapt", "examples/captures/front_kick.bvh"]
    ]
    assert main(adapt) == 0
    paragraph = HEADLESS[HEADLESS.index("--out adapted\n```") :].split("\n\n")[1]
    written = set(re.findall(r"`(adapted/\S+)`", paragraph))
    assert written == {str(file.relative_to(scratch)) for file in (scratch / "adapted").iterdir()}


def test_every_record_of_a_page_is_one_that_the_studio_reads(tmp_path, qapp):
    for page in PAGES:
        for number, text in enumerate(blocks(page, "json")):
            record = json.loads(text)
            if "markers" in record:
                file = tmp_path / f"{page.stem}_{number}.json"
                file.write_text(text, encoding="utf-8")
                assert read_map(file).name == record["name"]
            elif "format" in record:
                document = Document(make_project(frames=400, contacts=0))
                paste_json(document, text)
                [pasted] = document.project.contacts.values()
                assert pasted.point == record["contacts"][0]["point"]
                document.close()
            else:
                assert page.name == "headless.md"  # typed with --constraints above


@pytest.mark.parametrize(
    "page", [page for page in PAGES if "--write" not in page.read_text(encoding="utf-8")], ids=lambda page: page.name
)
def test_every_option_that_a_page_names_exists(page):
    known = set(ALWAYS)
    for add_arguments in ADD_ARGUMENTS.values():
        parser = ArgumentParser()
        add_arguments(parser)
        known |= set(parser._option_string_actions)
    assert set(OPTION.findall(page.read_text(encoding="utf-8"))) - known == set()


def test_headless_names_every_verb_and_every_option():
    for verb, add_arguments in ADD_ARGUMENTS.items():
        parser = ArgumentParser()
        add_arguments(parser)
        missing = {name for name in parser._option_string_actions if name.startswith("--")} - set(
            OPTION.findall(HEADLESS)
        )
        assert missing - ALWAYS == set(), verb
    assert set(re.findall(r"^\| `(\w+)", HEADLESS, re.MULTILINE)) >= set(VERBS)


def test_headless_names_every_kind_of_file_that_is_written_or_read_as_a_character():
    known = known_formats()
    table = HEADLESS[HEADLESS.index("## What can be written") : HEADLESS.index("`--joint-names ")]
    assert set(re.findall(r"`(\.\w+)`", table.split("| --- | --- |")[1])) >= set(known.suffixes("motion_writer"))
    sentence = HEADLESS[HEADLESS.index("Wherever a verb takes a character") :].split("`info` says")[0]
    assert set(re.findall(r"`(\.\w+)`", sentence)) == set(known.suffixes("character_reader"))


def test_headless_names_every_scene():
    assert [name for name in BUNDLED_SCENES if f"`{name}`" not in HEADLESS] == []


def test_headless_counts_the_bundled_strikes():
    assert "fourteen" in HEADLESS
    assert len(list(Path(bundled_strikes_folder()).glob("*.bvh"))) == 14
