"""Behaviour panel: the diagram of states and transitions, and the forms of its parts."""
