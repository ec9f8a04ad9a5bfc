"""Structure of a fitted rigid chain: canonical form, snapping, expansion, symmetries."""
