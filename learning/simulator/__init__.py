"""An arm to experiment on: torques in, settled configurations out."""
