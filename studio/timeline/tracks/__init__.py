"""What is drawn over time, a kind of row a file: where things lie, how they look, what is under the mouse."""
