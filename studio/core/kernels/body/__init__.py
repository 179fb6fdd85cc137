"""A posed body: from channels and back, its joints, its skin."""
