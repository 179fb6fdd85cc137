"""Tasks of the solver: their records, goals, residuals and Jacobian rows."""
