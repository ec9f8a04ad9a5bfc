"""Causes of torques that a model of gravity does not explain: tried, decided, named."""
