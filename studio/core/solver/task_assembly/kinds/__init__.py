"""Kinds of constraint in the solver: task record, target trajectory and residual of each."""
