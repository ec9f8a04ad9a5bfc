"""Local linear maps and what they are made of."""
