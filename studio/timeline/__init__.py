"""Timeline: tracks with bars, handles, curves and error strips over stage time."""
