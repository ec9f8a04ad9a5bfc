"""A rigid chain with causes beside gravity."""
