"""Timeline: bars, handles, curves and error strips over time."""
