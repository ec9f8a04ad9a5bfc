"""Fundamental domains of symmetry groups (BCTS)."""
