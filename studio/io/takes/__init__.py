"""Takes for export: those of a whole stage, and those on a character's own joints."""
