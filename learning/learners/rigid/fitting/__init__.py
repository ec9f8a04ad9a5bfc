"""Fit of a rigid chain to samples: search, refinement, acceptance."""
