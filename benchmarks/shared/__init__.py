"""Shared by benchmarks: arms, tables in documents, time limits, clear errors."""
