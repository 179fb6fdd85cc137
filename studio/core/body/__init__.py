"""Bodies: joints, measures, characters, and how a strange skeleton is found to be one."""
