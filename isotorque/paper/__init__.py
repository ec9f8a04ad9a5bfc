"""The paper's experiments, its published numbers and figures, and ours beside them."""
