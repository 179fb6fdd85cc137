"""Help is quick, numbers have ranges, and no option is another one cut short."""

import contextlib
import io
import math
import subprocess
import sys
from argparse import ArgumentError, ArgumentParser
from pathlib import Path

import pytest

from studio.cli.arguments import ADD_ARGUMENTS, add_export_options
from studio.cli.main import VERBS, main, make_parser
from studio.io.export_choices import REST_POSES

ODD = ("nan", "inf", "-inf", "1e400", "-1", "0", "1", "", "x", "1x", "70000", "2147483648", "1e9", "9" * 5000, "1@nan")
CAPTURE = "examples/captures/walk_turn.bvh"
FOUND = ["search", CAPTURE, "--target", "1", "0", "1"]


def numbers_of(verb):
    """The options of a verb whose text is parsed, but for paths."""
    parser = ArgumentParser()
    ADD_ARGUMENTS[verb](parser)
    return [action for action in parser._actions if action.type not in (None, Path)]


def test_help_of_every_verb_imports_neither_numba_nor_scipy():
    script = f"""
import contextlib, io, sys
from studio.cli.main import main
for verb in {list(VERBS)}:
    with contextlib.redirect_stdout(io.StringIO()) as shown, contextlib.suppress(SystemExit):
        main([verb, "--help"])
    assert f"usage: morpho-studio {{verb}}" in shown.getvalue(), verb
print([name for name in ("numba", "scipy", "sqlite3", "vtkmodules", "PySide6") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == "[]"


def test_every_verb_has_its_arguments():
    assert list(ADD_ARGUMENTS) == list(VERBS)


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("text", ODD)
def test_an_odd_number_is_a_finite_one_in_range_or_bad_usage(verb, text):
    for option in numbers_of(verb):
        assert option.type not in (int, float), option.dest
        parser = ArgumentParser(exit_on_error=False)
        parser.add_argument("--number", type=option.type)
        with contextlib.suppress(ArgumentError):
            value = parser.parse_args([f"--number={text}"]).number
            assert isinstance(value, tuple) or math.isfinite(value), option.dest


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["live", "--seconds", "nan"], "'nan' is not a number of seconds from 0 to 86,400"),
        (["live", "--stream", "0"], "'0' is not a port from 1 to 65,535"),
        (["live", "--stream=-1"], "'-1' is not a port"),
        (["live", "--port", "70000"], "'70000' is not a port"),
        (["live", "--strike-every", "0"], "'0' is not a number of seconds"),
        (["live", "--press", "K"], "'K' is not a key press"),
        (["live", "--press", "@1"], "not a key press"),
        (["live", "--press", "K@soon"], "not a key press"),
        (["live", "--press", "K@nan"], "not a key press"),
        ([*FOUND, "--count", "2147483648"], "'2147483648' is not a number of clips"),
        ([*FOUND, "--target", "nan", "0", "1"], "'nan' is not a number of metres"),
        ([*FOUND, "--posture-weight=-1"], "'-1' is not a weight"),
        ([*FOUND, "--reach-weight", "inf"], "'inf' is not a weight"),
        (["render", CAPTURE, "--out", "x.mp4", "--film-rate", "0"], "'0' is not a number of frames per second"),
        (["render", CAPTURE, "--out", "x.png", "--time=-1"], "'-1' is not a number of seconds"),
        (["render", CAPTURE, "--out", "x.png", "--size", "15x90"], "'15x90' is not a size"),
        (["info", CAPTURE, "--frame-rate", "0"], "'0' is not a number of frames per second"),
        (["info", CAPTURE, "--frame-rate=-25"], "'-25' is not a number of frames per second"),
        (["bench", "--runs", "0"], "'0' is not a number of runs"),
        (["batch", ".", "--out", "x", "--workers", "0"], "'0' is not a number of processes"),
        (["render", CAPTURE, "--out", "x.png", "--frame", "154"], "unrecognized arguments: --frame 154"),
        (["info", CAPTURE, "--js"], "unrecognized arguments: --js"),
    ],
)
def test_a_number_beyond_its_range_or_half_an_option_is_bad_usage(words, sentence, capsys):
    with pytest.raises(SystemExit) as end:
        main(words)

    assert end.value.code == 2
    assert sentence in capsys.readouterr().err


def test_a_receiver_without_a_port_is_refused_and_not_ignored(capsys):
    assert main(["live", "--stream-to", "127.0.0.1", "--seconds", "1"]) == 1
    assert "--stream PORT" in capsys.readouterr().err


def test_the_rest_poses_to_choose_are_those_that_exports_know():
    parser = ArgumentParser()
    add_export_options(parser)
    [rest_pose] = [action for action in parser._actions if action.dest == "rest_pose"]

    assert list(rest_pose.choices) == list(REST_POSES)


def test_the_help_of_the_studio_names_every_verb():
    with contextlib.redirect_stdout(io.StringIO()) as shown, contextlib.suppress(SystemExit):
        make_parser(None, {}).parse_args(["--help"])

    assert all(verb in shown.getvalue() for verb in VERBS)
