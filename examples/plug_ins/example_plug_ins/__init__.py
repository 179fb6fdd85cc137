"""A verb and a panel that a package adds to Morpho Studio."""
