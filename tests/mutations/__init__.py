"""Mutations of guards, margins and bounds, and the tests that must notice each of them."""
