"""Goal-directed exploration: direction sampling, goal babbling, and what constrains them."""
