"""Symmetries identified by fitting one potential."""
