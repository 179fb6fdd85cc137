"""S4D, the studio's archive of a motion with what is known of it: read and written."""
