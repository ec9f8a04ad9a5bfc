"""Runs of one robot, from file to model: discovery, learning, judgement; from recordings too."""
