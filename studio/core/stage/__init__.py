"""The stage: what performers play, where they stand, the props beside them."""
