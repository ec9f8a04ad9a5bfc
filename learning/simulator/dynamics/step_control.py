"""The numbers that both engines control their steps by."""

from __future__ import annotations

VELOCITY_WEIGHT = 0.05  # [s]: how much an error in velocity counts as one in angle
FIRST_STEP = 0.1  # [s], at most
SHORTEST_STEP = 1e-6  # [s]; shorter ones are accepted whatever their error
LONGEST_STEP = 2.0  # [s]
SAFETY = 0.9
GROWTH = 4.0
SHRINKAGE = 0.2
FLOOR = 1e-3  # of the tolerance: error allowed however slow the arm
RESIDUAL = 1e-11  # of the arm's torque scale: imbalance allowed at a finished equilibrium
NEWTON_STEPS = 6  # at most
CONTRACTION = 0.25  # of each of Newton's steps, at most this is left for the next
TIME_ROUNDING = 1e-12  # [s]
