"""The 3D view of the stage."""

import logging

# pyvista imports matplotlib, whose warnings of its font cache and folder are of no use: no picture has text by it.
logging.getLogger("matplotlib").setLevel(logging.ERROR)
