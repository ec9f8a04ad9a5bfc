"""Claims about measured torques, and causes named, held against contaminated arms."""
