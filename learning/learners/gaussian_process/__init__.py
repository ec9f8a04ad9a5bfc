"""Gaussian processes, with and without symmetries."""
