"""The stage: performers with their clips and positions, and props."""
