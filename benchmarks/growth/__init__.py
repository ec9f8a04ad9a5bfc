"""How costs grow with joints, samples, prototypes and the order of the symmetry group."""
