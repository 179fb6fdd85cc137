"""Network input and output in real time, and live play of performers, without a window."""
