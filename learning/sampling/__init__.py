"""Samples for batch learning: lattices that fill a domain evenly."""
