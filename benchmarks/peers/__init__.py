"""Other programs that the toolkit is measured beside."""
