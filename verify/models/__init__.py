"""Judges of learned models."""
