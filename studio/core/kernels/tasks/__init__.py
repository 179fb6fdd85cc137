"""Tasks: their targets, residuals and Jacobian rows."""
