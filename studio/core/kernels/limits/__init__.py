"""What may not be: joints beyond their limits, a root out of reach of its feet, arms in their own body."""
