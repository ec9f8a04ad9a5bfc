"""Growth of costs with joints, samples, prototypes and the order of the symmetry group."""
