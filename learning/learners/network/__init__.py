"""Feed-forward networks with one hidden layer."""
