"""Robots x learners x seeds from one table."""
