"""The reference engine: Pinocchio's algorithms."""
