"""Logs of real arms: tables of any kind, their columns and units, and the poses in them."""
