"""The morphology-independent motion: normalise, realise, edit."""
