"""Robots: files, kinematic tree, snapping of rounded angles."""
