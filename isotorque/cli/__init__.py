"""The command line of Isotorque: one file per command."""
