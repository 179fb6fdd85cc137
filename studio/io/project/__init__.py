"""The studio's own JSON: a project and its entities, alone or in their archive."""
