"""Symmetries learned from pairs of samples (section 4.2 of the paper)."""
