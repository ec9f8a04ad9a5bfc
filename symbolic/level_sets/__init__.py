"""Level sets of the torque: all configurations of one absolute torque."""
