"""All compiled loops of the studio."""
