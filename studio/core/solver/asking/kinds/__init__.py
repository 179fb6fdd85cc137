"""Kinds of constraint: task record, target trajectory and residual of each."""
