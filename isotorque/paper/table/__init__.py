"""The table of the paper's numbers beside ours."""
