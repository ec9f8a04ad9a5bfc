"""Runs on disk: every command of an arm, committed before the next one; data from elsewhere."""
