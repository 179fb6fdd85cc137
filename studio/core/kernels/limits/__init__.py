"""Inequalities: joint limits, reach of the root over planted feet, self-collision of the arms."""
