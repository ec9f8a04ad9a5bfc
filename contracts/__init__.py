"""Contracts on imports that Import Linter does not know by itself."""
