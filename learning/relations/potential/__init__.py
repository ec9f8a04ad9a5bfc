"""Fits of one potential to static samples."""
