"""The set of static torques (SST) that a robot has found it can hold."""
