"""Machine of a measurement, in words."""

import os
import platform
from pathlib import Path

import numba
import numpy as np


def machine() -> str:
    """Processor, cores, system and the versions that matter."""
    return (
        f"{_processor()}, {os.cpu_count()} cores shared, {platform.system()}; "
        f"Python {platform.python_version()}, numpy {np.__version__}, numba {numba.__version__}"
    )


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.processor() or platform.machine())
