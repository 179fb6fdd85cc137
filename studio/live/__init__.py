"""Real-time input and output over the network, and live playback of performers, without a window."""
