"""Costs that grow with the work, measured as ratios, side by side in one process."""
