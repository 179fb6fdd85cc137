"""What the actions do: one function a verb, each takes the workbench."""
