"""Integer lattices: normal forms, short vectors, Voronoi polytopes."""
