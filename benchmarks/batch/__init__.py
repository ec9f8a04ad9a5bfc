"""Batch learning from lattices: test error with and without symmetries."""
