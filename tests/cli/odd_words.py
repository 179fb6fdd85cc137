"""Command lines that nobody types: every verb and option with odd numbers, names, files and folders, one a seed."""

import io
import os
import shutil
from argparse import Action, ArgumentParser
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from random import Random

from studio.cli.arguments import ADD_ARGUMENTS
from studio.cli.main import main
from studio.io.export import write_capture
from studio.resources_folder import example_captures_folder
from tests.builders import make_capture

ODD = (
    "nan", "inf", "-inf", "1e400", "-1", "0", "1", "", "x", "1x", "70000", "2147483648", "1e9", "9" * 500, "1@nan",
    "0x10", "1_000", "\u0661", "1e-300", "-0", "0.5", "1,5", "65536", "64x64", "99999x99999", "K@1", "@", "K@-1",
    "300.300.300.300", "localhost", "no.such.host.invalid", "::1", "255.255.255.255", "\udc80", "\u202e", "a" * 300,
    "..", "/dev/null", ".", "~", "child", "nobody", "zero", "999999", "Y", "-Z", "0 0 0", ".bvh", "glb", "1/0", "None",
    "empty", "empty.bvh", "noise.json", "list.json", "folder.bvh", "head.osc", "half.studio", "walk.bvh", "walks",
)  # fmt: skip
BASES = {
    "info": (("walk.bvh",),),
    "convert": (("walk.bvh", "out/a.bvh"), ("walk.bvh", "out/a.glb")),
    "adapt": (("walk.bvh", "--character", "child", "--out", "out"),),
    "batch": (("walks", "--character", "child", "--out", "out", "--workers", "1"),),
    "index": (("walks",), ()),
    "search": (("kick.bvh", "--target", "1", "0", "1", "--bundled"),),
    "live": (("--seconds", "0.2", "--fast", "--bundled"), ("--seconds", "0.1", "--stage", "a-clap", "--fast")),
    "formats": ((),),
    "script": ((),),
}
"""Words with which each verb does its work; pictures and measurements take too long."""


def make_files(folder: Path) -> None:
    """Put captures, and files that are none, into a folder."""
    write_capture(make_capture(frames=20), folder / "walk.bvh")
    shutil.copy(example_captures_folder() / "front_kick.bvh", folder / "kick.bvh")
    for name in ("walks", "folder.bvh"):
        (folder / name).mkdir()
    shutil.copy(folder / "walk.bvh", folder / "walks")
    contents = {
        "empty": b"",
        "empty.bvh": b"",
        "noise.json": bytes(range(256)),
        "list.json": b"[1, 2]",
        "head.osc": b"MSOSC1\0\0",
        "half.studio": b"PK\3\4",
    }
    for name, content in contents.items():
        (folder / name).write_bytes(content)


def odd_words(random: Random) -> list[str]:
    """Command line of a verb with up to three options whose values are mostly odd."""
    verb = random.choice(sorted(BASES))
    words = list(random.choice(BASES[verb]))
    if not words:
        words += random.choices(ODD, k=random.choice([0, 1]))
    elif random.random() < 0.2:
        words[random.randrange(len(words))] = random.choice(ODD)
    parser = ArgumentParser()
    ADD_ARGUMENTS[verb](parser)
    options = [action for action in parser._actions if action.option_strings and action.dest != "help"]
    for option in random.choices(options, k=random.choice([1, 1, 2, 3]) if options else 0):
        name, values = option.option_strings[-1], odd_values(random, option)
        words += [f"{name}={values[0]}"] if len(values) == 1 and random.random() < 0.3 else [name, *values]
    return [verb, *words]


def odd_values(random: Random, option: Action) -> list[str]:
    """Values of an option: as many as it takes, or hardly."""
    if option.nargs == 0:
        return []
    count = option.nargs if isinstance(option.nargs, int) else random.choice([0, 1, 2]) if option.nargs else 1
    choices = [str(choice) for choice in option.choices or ()]
    return [random.choice(choices if choices and random.random() < 0.6 else ODD) for _ in range(count)]


def play(seed: int, folder: Path) -> int:
    """Run an odd command line in a folder and a home of its own; returns the exit code.

    Raises AssertionError where the user reads a stack, or a failure is without a word.
    """
    home = folder / "home"
    if not home.exists():
        make_files(folder)
        for kind in ("CONFIG", "DATA", "STATE"):
            os.environ[f"XDG_{kind}_HOME"] = str(home / kind.lower())
        home.mkdir()
    words, told = odd_words(Random(seed)), io.StringIO()
    with chdir(folder), redirect_stdout(told), redirect_stderr(told):
        try:
            code = main(words)
        except SystemExit as usage:
            code = int(usage.code or 0)
    text = told.getvalue()
    assert code in (0, 1, 2), f"{words}: exit code {code}"
    assert not {"Traceback", "[Errno"} & set(text.split()), f"{words}: {text}"
    assert code == 0 or len(text.strip()) > 10, f"{words}: no sentence"
    return code
