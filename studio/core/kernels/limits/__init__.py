"""Inequalities: joint limits, the root's reach of planted feet, self-collision of the arms."""
