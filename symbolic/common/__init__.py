"""The ground room: errors, angles, array types, strict JSON, whole-or-nothing file writing."""
