"""From a motion, a character and constraints to an adapted pose sequence."""
