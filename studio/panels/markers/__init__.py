"""Parts of the markers dialog: the marker map, the cleaning steps, and other recorded signals."""
