"""How good adapted motions are, beside their sources."""
