"""The pictures and films of README and guide: the real window, driven and grabbed without a display."""
