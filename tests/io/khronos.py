"""The Khronos glTF validator, installed once into the checkout's cache folder and run by node."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.patience import SECONDS

PACKAGE = "gltf-validator@2.0.0-dev.3.10"
FOLDER = Path(__file__).resolve().parents[2] / ".cache" / "gltf-validator"
SCRIPT = """
const validator = require("gltf-validator");
const content = new Uint8Array(require("fs").readFileSync(process.argv[1]));
validator.validateBytes(content, {maxIssues: 50}).then(report => console.log(JSON.stringify(report.issues)));
"""


def issues_of(path: Path) -> dict[str, Any]:
    """Findings of the validator in a file: ``numErrors``, ``numWarnings``, ``messages``. Skips where it cannot run."""
    _install()
    done = subprocess.run(
        ["node", "-e", SCRIPT, str(path)], cwd=FOLDER, capture_output=True, text=True, timeout=SECONDS, check=True
    )
    issues: dict[str, Any] = json.loads(done.stdout)
    return issues


def _install() -> None:
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not here to run the Khronos validator")
    if (FOLDER / "node_modules" / "gltf-validator" / "index.js").is_file():
        return
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "package.json").write_text('{"private": true}')
    try:
        subprocess.run(
            ["npm", "install", "--silent", "--no-audit", "--no-fund", PACKAGE],
            cwd=FOLDER, capture_output=True, text=True, timeout=SECONDS, check=True,
        )  # fmt: skip
    except subprocess.SubprocessError as error:
        pytest.skip(f"the Khronos validator could not be installed by npm: {error}")
