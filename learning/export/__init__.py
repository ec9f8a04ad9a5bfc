"""Learned models for controllers: C source, CasADi functions, plain arrays."""
