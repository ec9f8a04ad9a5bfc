"""Samples that the online learners need on the simulated arm, beside what is demanded."""
