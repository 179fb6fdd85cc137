"""Imports before the window is shown, and those while somebody looks at it."""

import os
import subprocess
import sys

import pytest

from tests.architecture.sources import ROOT

LATE = "numba", "scipy", "vtkmodules", "pyvista", "pyqtgraph", "matplotlib", "PIL", "studio.core.solver.adapt"


def test_the_window_opens_before_what_computes_and_draws_is_loaded():
    script = f"import sys, studio.app.application; print(*({{*{LATE}}} & sys.modules.keys()))"
    done = subprocess.run((sys.executable, "-c", script), cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.fixture(scope="module")
def view_imported(tmp_path_factory):
    """The process that has loaded the 3D view, its late modules printed, and then a library for charts as well."""
    later = "scipy.ndimage", "scipy.interpolate", "scipy.spatial", "pyqtgraph", "studio.core.solver.adapt"
    script = (
        "import sys; from studio.app import application; application.import_viewport();"
        f"print(*({{*{later}}} & sys.modules.keys())); import matplotlib.pyplot"
    )
    file = tmp_path_factory.mktemp("charts") / "file"
    file.write_text("")
    nowhere = os.environ | {"MPLCONFIGDIR": str(file / "matplotlib")}
    return subprocess.run(
        (sys.executable, "-c", script), cwd=ROOT, capture_output=True, text=True, env=nowhere, check=True
    )


def test_the_3d_view_says_nothing_of_folders_and_fonts_it_does_not_use(view_imported):
    assert view_imported.stderr == ""


def test_the_3d_view_draws_before_what_only_others_need_is_loaded(view_imported):
    assert view_imported.stdout.split() == []
