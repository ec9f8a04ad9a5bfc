"""What physics says, exactly: robots, gravity, relations and groups, symmetries, BCTS, level sets."""
