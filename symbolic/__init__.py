"""Physics of an arm, exactly: robots, gravity, relations, symmetries, BCTS, level sets."""
