"""Folders are indexed and searched from the command line."""

import json
from pathlib import Path

import pytest

from studio.cli.main import main

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    place = tmp_path_factory.mktemp("library")
    assert main(["index", str(EXAMPLES), "--library", str(place)]) == 0
    return str(place)


def printed(capsys):
    return json.loads(capsys.readouterr().out)


def test_index_lists_clips_and_actors(library, capsys):
    assert main(["index", "--library", library, "--json"]) == 0
    report = printed(capsys)
    assert [clip["limb"] for clip in report["clips"]] == ["right leg", "right arm"]
    assert len(report["actors"]) == 1


def test_a_folder_that_is_not_there_is_a_problem(library, capsys):
    assert main(["index", "no such folder", "--library", library, "--json"]) == 1
    assert list(printed(capsys)["problems"].values()) == ["The folder is not there."]


def test_search_ranks_clips_with_reasons(library, capsys):
    ask = ["search", str(EXAMPLES / "walk_turn.bvh"), "--target", "0.7", "-0.1", "1.35", "--library", library, "--json"]
    assert main([*ask, "--character", "child"]) == 0
    results = printed(capsys)["results"]
    assert [each["cost"] for each in results] == sorted(each["cost"] for each in results)
    assert all(len(each["reasons"]) == 3 and each["seconds_to_hit"] > 0.1 for each in results)
    assert main([*ask, "--kind", "kick"]) == 0
    assert [each["kind"] for each in printed(capsys)["results"]] == ["kick"]


def test_search_of_a_frame_there_is_not_says_which_there_are(library, capsys):
    ask = ["search", str(EXAMPLES / "walk_turn.bvh"), "--target", "1", "0", "1", "--library", library]
    assert main([*ask, "--frame", "9999"]) == 1
    assert "has frames 0 to" in capsys.readouterr().err


def test_a_library_where_nothing_can_be_written_is_told_without_an_error_number(tmp_path, capsys):
    file = tmp_path / "home"
    file.write_text("")
    assert main(["index", str(EXAMPLES), "--library", str(file / "library")]) == 1
    told = capsys.readouterr().err
    assert f"The library's folder '{file / 'library'}' cannot be used: Not a directory." in told
    assert "Errno" not in told


def test_search_finds_the_bundled_strikes_in_a_library_that_is_empty(tmp_path, capsys):
    ask = ["search", str(EXAMPLES / "walk_turn.bvh"), "--target", "0.7", "0", "1.35", "--library", str(tmp_path)]
    assert main([*ask, "--bundled", "--json"]) == 0
    assert len(printed(capsys)["results"]) == 8


def test_search_of_an_empty_library_says_how_to_fill_it(tmp_path, capsys):
    assert main(["search", str(EXAMPLES / "walk_turn.bvh"), "--target", "1", "0", "1", "--library", str(tmp_path)]) == 1
    assert "`index FOLDER`, or the bundled strikes with `--bundled`" in capsys.readouterr().err
