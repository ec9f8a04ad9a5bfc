"""Trigonometric polynomials in the joint angles."""
