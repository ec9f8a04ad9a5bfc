"""Judges: what was learned held against what is true; reports, figures, test tools."""
