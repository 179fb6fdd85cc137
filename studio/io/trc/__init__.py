"""TRC: the tracks of optical markers as a table of text (Motion Analysis, OpenSim)."""
