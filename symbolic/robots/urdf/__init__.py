"""URDF files: parsed, checked, and read as the body of an arm."""
