"""Functions of the actions, one a verb; each takes the workbench."""
