"""A motion on the ground before anything is asked of it: footprints, feet, all that carries the body."""
