"""Functions of the actions; each takes the Workbench."""
