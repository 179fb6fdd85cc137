"""The published wheel works in an empty environment, away from the checkout."""

import json
import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT
from tests.architecture.test_readme import links_of

BIN = "Scripts" if sys.platform == "win32" else "bin"


def run(*command, cwd, **environment):
    words, variables = [str(word) for word in command], {**os.environ, **environment}
    done = subprocess.run(words, cwd=cwd, env=variables, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def away(tmp_path_factory):
    """A folder with an environment that holds the wheel; the packages it needs are borrowed from this one."""
    folder = tmp_path_factory.mktemp("away")
    run(sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder, ROOT, cwd=folder)
    [wheel] = folder.glob("morpho_studio-*.whl")
    venv.create(folder / "venv", with_pip=False)
    python = folder / "venv" / BIN / "python"
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", python)
    run(*pip, "install", "--no-deps", "--no-index", wheel, cwd=folder)
    [packages] = {Path(line) for line in run(python, "-c", PRINT_PACKAGES, cwd=folder).splitlines()}
    # A path line adds the folder only; the .pth inside it that points at the checkout is not followed.
    (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder


def test_the_file_to_which_a_help_text_points_is_in_the_wheel(away):
    told = run(away / "venv" / BIN / "morpho-studio", "adapt", "--help", cwd=away)
    [path] = (Path(word) for word in told.split() if word.endswith("headless.md"))
    assert away in path.parents
    assert "# Without a window" in path.read_text(encoding="utf-8")
    assert dead_links(path) == []


def dead_links(page):
    """Links of a page, and of the pages that it links to, at which there is no file."""
    waiting, seen, dead = [page], set(), []
    while waiting:
        page = waiting.pop()
        seen.add(page)
        for link in links_of(page):
            goal = (page.parent / link.partition("#")[0]).resolve() if not link.startswith("#") else page
            if not goal.exists():
                dead.append(f"{page.name}: {link}")
            elif goal.suffix == ".md" and goal not in seen:
                waiting.append(goal)
    return dead


PRINT_PACKAGES = "import sysconfig; print(sysconfig.get_path('purelib'))"
PRINT_PLACES = """
from studio.resources_folder import bundled_strikes_folder, example_captures_folder, resources_folder
print(resources_folder(), example_captures_folder(), bundled_strikes_folder(), sep="\\n")
"""


def test_the_wheel_carries_the_studio_and_its_own_files(away):
    python = away / "venv" / BIN / "python"
    places = [Path(line) for line in run(python, "-c", PRINT_PLACES, cwd=away).splitlines()]
    sources = [ROOT / "resources", ROOT / "examples" / "captures", ROOT / "examples" / "strikes"]
    for place, source in zip(places, sources, strict=True):
        assert away in place.parents
        assert names_in(place) == names_in(source)


def names_in(folder):
    files = (file.relative_to(folder) for file in folder.rglob("*") if file.is_file())
    return {str(file) for file in files if "__pycache__" not in file.parts}


def test_the_installed_command_explains_itself_away_from_the_checkout(away):
    assert "COMMAND" in run(away / "venv" / BIN / "morpho-studio", "--help", cwd=away)


def test_the_installed_command_knows_its_version(away):
    [wheel] = away.glob("morpho_studio-*.whl")
    version = wheel.name.split("-")[1]
    assert version in run(away / "venv" / BIN / "morpho-studio", "--version", cwd=away)


def test_the_installed_command_reads_a_bundled_capture_away_from_the_checkout(away):
    """Its kernels are interpreted: compiled, they are tested where they need not be compiled again."""
    python = away / "venv" / BIN / "python"
    captures = Path(run(python, "-c", PRINT_PLACES, cwd=away).splitlines()[1])
    command = away / "venv" / BIN / "morpho-studio", "info", "--json", min(captures.glob("*.bvh"))
    [record] = json.loads(run(*command, cwd=away, NUMBA_DISABLE_JIT="1"))
    assert record["ok"]
    assert record["round_trip"]["position_mm"] < 0.1
