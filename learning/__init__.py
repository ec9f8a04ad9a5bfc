"""The robot that knows nothing: simulation, discovery, exploration, learners, recordings."""
