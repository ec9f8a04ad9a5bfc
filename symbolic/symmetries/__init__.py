"""Symmetries of a potential: exact, approximate, with proofs and bounds."""
