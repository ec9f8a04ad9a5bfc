"""Judges of learned static torques."""
