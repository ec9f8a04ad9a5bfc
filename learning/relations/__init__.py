"""Symmetry relations from recordings: pairing, identification, group completion, confirmation."""
