"""Each kind of constraint: how it is written as a row, and by how much it is missed."""
