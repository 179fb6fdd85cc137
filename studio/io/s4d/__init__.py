"""S4D, the studio's archive of a motion with its annotations: read and written."""
