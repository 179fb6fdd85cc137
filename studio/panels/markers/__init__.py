"""The parts of the markers dialog: which marker is what, how the trial is cleaned, what else was recorded."""
