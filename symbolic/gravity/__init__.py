"""Gravity: exact potential, torque, stiffness, and their forms for programs and people."""
