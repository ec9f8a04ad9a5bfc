"""Symmetry relations and the finite groups that they form."""
