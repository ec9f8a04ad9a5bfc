"""Judges of relations: proof, bound, test or counterexample."""
