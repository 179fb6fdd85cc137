"""Quality of adapted motions relative to their sources."""
