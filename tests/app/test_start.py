"""Imports before the window is shown, and those while somebody looks at it."""

import os
import subprocess
import sys

from tests.architecture.sources import ROOT

LATE = "numba", "scipy", "vtkmodules", "pyvista", "pyqtgraph", "matplotlib", "PIL", "studio.core.solver.adapt"


def test_the_window_opens_before_what_computes_and_draws_is_loaded():
    script = f"import sys, studio.app.application; print(*({{*{LATE}}} & sys.modules.keys()))"
    done = subprocess.run((sys.executable, "-c", script), cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_the_3d_view_says_nothing_of_folders_and_fonts_it_does_not_use(tmp_path):
    (tmp_path / "file").write_text("")
    nowhere = os.environ | {"MPLCONFIGDIR": str(tmp_path / "file" / "matplotlib")}
    script = "from studio.app import application; application.import_viewport(); import matplotlib.pyplot"
    done = subprocess.run(
        (sys.executable, "-c", script), cwd=ROOT, capture_output=True, text=True, env=nowhere, check=True
    )
    assert done.stderr == ""


def test_the_3d_view_draws_before_what_only_others_need_is_loaded():
    later = "scipy.ndimage", "scipy.interpolate", "scipy.spatial", "pyqtgraph", "studio.core.solver.adapt"
    script = (
        "import sys; from studio.app import application; application.import_viewport();"
        f"print(*({{*{later}}} & sys.modules.keys()))"
    )
    done = subprocess.run((sys.executable, "-c", script), cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
