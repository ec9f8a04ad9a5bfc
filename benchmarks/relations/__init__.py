"""Relation learning from recordings: samples and torques that the whole group takes."""
