"""Table of the dependencies' wheels for each system and Python: ``python -m tests.wheels`` asks the package index.

Nothing is installed. The exit code is 1 where a set does not resolve.
"""

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

SYSTEMS = {
    "Linux": ["manylinux_2_17_x86_64", "manylinux_2_28_x86_64", "manylinux_2_34_x86_64"],
    "Windows": ["win_amd64"],
    "macOS (Apple silicon)": ["macosx_11_0_arm64", "macosx_12_0_arm64", "macosx_13_0_arm64", "macosx_14_0_arm64"],
    "macOS (Intel)": ["macosx_10_13_x86_64", "macosx_11_0_x86_64", "macosx_12_0_x86_64", "macosx_13_0_x86_64"],
}
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
EXTRAS = ("fbx", "usd", "batch")
PROJECT = Path(__file__).parents[1] / "pyproject.toml"


def resolves(requirements: list[str], platforms: list[str], python: str) -> str:
    """The complaint of pip where ``requirements`` have no wheels together; empty where they have."""
    chosen = [part for platform in platforms for part in ("--platform", platform)]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [
                *(sys.executable, "-m", "pip", "install", "--dry-run", "--quiet", "--ignore-installed"),
                *("--only-binary", ":all:", "--target", folder, "--python-version", python),
                *chosen,
                *requirements,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
    return "" if done.returncode == 0 else done.stderr.strip().splitlines()[-1]


def main() -> int:
    """Print a line for each system and Python."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    requirements = [
        *project["dependencies"],
        *(each for extra in EXTRAS for each in project["optional-dependencies"][extra]),
    ]
    failed = 0
    for system, platforms in SYSTEMS.items():
        for python in PYTHONS:
            complaint = resolves(requirements, platforms, python)
            failed += bool(complaint)
            print(f"{system}, Python {python}: {complaint or 'every dependency has a wheel'}", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
