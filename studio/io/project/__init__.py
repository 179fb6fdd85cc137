"""Project files: a project and its entities as JSON, alone or in an archive."""
