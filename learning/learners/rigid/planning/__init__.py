"""Uncertainty of a fitted rigid chain, and the next poses that lower it most."""
