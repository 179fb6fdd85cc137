"""Real time without a window: what comes in and goes out over the network, and a fighter that strikes."""
