"""Tools for tests: strategies, brute force, counterexamples."""
