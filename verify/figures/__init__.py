"""Figures as pure functions from arrays to Matplotlib figures."""
