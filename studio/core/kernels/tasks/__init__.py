"""What is asked: tasks, their targets, errors and Jacobian rows."""
