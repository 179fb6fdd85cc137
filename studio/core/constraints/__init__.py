"""What the user asks of a motion: one file a kind; priority, chain and activation are common to all."""
