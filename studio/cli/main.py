"""Command line: one file for each verb, imported only when it runs."""

import errno
import json
import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from importlib.metadata import entry_points
from io import TextIOWrapper
from typing import TYPE_CHECKING

from studio import __version__
from studio.cli.printing import INTERRUPTED_EXIT_CODE
from studio.core.errors import Stopped, StudioError
from studio.io import plug_ins
from studio.io.registry import known_formats
from studio.startup.process import check_libraries, has_display, prepare_process

if TYPE_CHECKING:
    from studio.startup.kernel_warm_up import WarmUp

VERBS = {
    "info": "show what a file contains, what was assumed, and the round-trip error",
    "convert": "write a motion in another file format",
    "adapt": "adapt a capture to characters and report what was reached",
    "batch": "adapt every capture of a folder, by many processes",
    "index": "index folders of captures into the motion library",
    "search": "find the clip of the library that best hits a position",
    "live": "run a character that strikes at a tracked head, streamed as VMC",
    "formats": "list the kinds of files that can be read and written",
    "render": "render a project or a capture to an image or a video",
    "bench": "benchmark the solver on this machine",
    "script": "run a Python script that uses studio.api",
}
WORK_FAILED, PIPE_CLOSED = 1, 141
"""Exit codes: the work failed; the reader of the output pipe has closed it."""
DISK_FULL_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Error numbers of a full disk. Writers of files report it themselves, so these errors come from the
standard output.
"""
MOST_PATH_CHARACTERS = 300
"""Maximum number of characters of a path in a message."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb, or open the window if none is named.

    Returns the exit code: 0 done, 1 the work failed, 130 stopped with Ctrl-C, 141 closed output pipe (``info FILE |
    head``). Wrong usage ends the process with 2, as in argparse.
    """
    given = sys.argv[1:] if arguments is None else arguments
    if isinstance(sys.stdout, TextIOWrapper):  # names of files may have bytes that are no UTF-8
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        try:
            return _run(given)
        except KeyboardInterrupt:
            report(Stopped("Stopped. No file was left incomplete."), "--json" in given)
            return INTERRUPTED_EXIT_CODE
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except BrokenPipeError:
        _discard_output()
        return PIPE_CLOSED
    except OSError as error:
        if error.errno not in DISK_FULL_ERRORS:
            raise
        _discard_output()
        report(
            StudioError(f"The output could not be written: {error.strerror}. Make room or choose another disk."), False
        )
        return WORK_FAILED


def _discard_output() -> None:
    """Discard the buffered output that Python would write at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(given: Sequence[str]) -> int:
    prepare_process()
    plug_ins.load_registered()
    added = {offer.name: offer for offer in plug_ins.plug_in_entries(plug_ins.VERBS_GROUP) if offer.name not in VERBS}
    verb = next((word for word in given if word in VERBS or word in added), None)
    files = [word for word in given if word.lower().endswith(window_suffixes())] if verb is None else []
    try:
        plug_in = added[verb].load(plug_ins.verb_of) if verb in added else None
        parser = make_parser(verb, {name: plug_in if name == verb else offer for name, offer in added.items()})
    except StudioError as error:
        report(error, "--json" in given)
        return WORK_FAILED
    parsed = parser.parse_args([word for word in given if word not in files])
    wants_json = getattr(parsed, "json", False)
    try:
        if plug_in is not None:
            return plug_in.run(parsed)
        if verb is not None:
            run: Callable[[Namespace], int] = import_module(f"studio.cli.{verb}").run
            return run(parsed)
        if has_display():
            return open_window(files)
        if files:
            raise StudioError(f"No display is available to open {', '.join(files)} in. Use a command: see --help.")
        return run_example()
    except StudioError as error:
        report(error, wants_json)
        return INTERRUPTED_EXIT_CODE if isinstance(error, Stopped) else WORK_FAILED
    except OSError as error:
        if not isinstance(error.filename, str | bytes):
            raise
        name = os.fsdecode(error.filename)
        shown = name if len(name) <= MOST_PATH_CHARACTERS else f"{name[:MOST_PATH_CHARACTERS]}…"
        report(StudioError(f"'{shown}' cannot be used: {error.strerror}. Choose another name or folder."), wants_json)
        return WORK_FAILED


def make_parser(verb: str | None, added: Mapping[str, plug_ins.Verb | plug_ins.PlugInEntry | None]) -> ArgumentParser:
    """Parser with the names of all verbs, and the options of ``verb``.

    ``added`` are the verbs of installed packages; only the one that is named is loaded.
    """
    parser = ArgumentParser(
        prog="morpho-studio",
        allow_abbrev=False,
        description="Adapts captured motions live to any character.",
        epilog="Without a command the window opens with the given captures and projects. Each command has its"
        " own --help.",
    )
    parser.add_argument("--version", action="version", version=f"Morpho Studio {__version__}")
    verbs = parser.add_subparsers(title="commands", metavar="COMMAND")
    for name, summary in VERBS.items():
        description = summary[0].upper() + summary[1:] + "."
        verb_parser = verbs.add_parser(name, help=summary, description=description, allow_abbrev=False)
        if name == verb:
            import_module("studio.cli.arguments").ADD_ARGUMENTS[name](verb_parser)
    for name, plug_in in added.items():
        if isinstance(plug_in, plug_ins.Verb):
            plug_in.add_arguments(verbs.add_parser(name, description=plug_in.summary, allow_abbrev=False))
        elif plug_in is not None:
            verbs.add_parser(name, help=f"added by {plug_in.package}")
    return parser


def window_suffixes() -> tuple[str, ...]:
    """Suffixes of the files that the window opens when they are named without a verb."""
    return (".studio", *known_formats().suffixes("capture_reader", "character_reader"))


def report(error: StudioError, as_json: bool) -> None:
    """Print an error: one sentence on standard error, or one JSON document on standard output."""
    if as_json:
        print(json.dumps({"ok": False, "error": str(error)}, ensure_ascii=False))
    else:
        print(f"morpho-studio: {error}", file=sys.stderr)


def open_window(files: Sequence[str] | None = None) -> int:
    """Start the window with ``files``, by default those of the process's own command line, and return the exit code.

    The window is found by its entry point, so that this module imports no window toolkit.
    """
    prepare_process()
    check_libraries(window=True)
    found = entry_points(group="morpho_studio.window", name="main")
    if not found:
        raise StudioError("The desktop application is not installed. Install it with `pip install -e .`.")
    # It compiles while the window is imported.
    warm_up = import_module("studio.startup.kernel_warm_up").WarmUp(held=True)
    window: Callable[[Sequence[str] | None, WarmUp], int] = next(iter(found)).load()
    return window(files, warm_up)


def run_example() -> int:
    """Run the bundled example, as there is no display, and print why."""
    example: Callable[[], int] = import_module("studio.cli.example").run_example
    return example()
