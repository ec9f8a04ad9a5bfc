"""What physics says, exactly: robots, gravity, relations, symmetries, BCTS, level sets."""
