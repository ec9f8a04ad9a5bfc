"""Learners that keep their samples."""
