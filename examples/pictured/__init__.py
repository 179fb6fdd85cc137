"""The pictures and films of README and guide: the real window, driven and grabbed without a display."""

from studio.startup.process import prepare_process

prepare_process()  # else numba keeps kernels beside their sources, where they outlive changes of what they call
