"""A rigid chain and Gaussian processes of what it leaves: cables, springs, bending."""
