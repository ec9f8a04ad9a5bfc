"""Numbers printed in the paper, sections 3 to 7.

References
----------
Rayyes, Kubus, Steil (2018), "Learning Inverse Statics Models Efficiently With Symmetry-Based
Exploration", Frontiers in Neurorobotics 12:68.
"""

from __future__ import annotations

import math

# 3.2.1, Fig. 2: symmetric configurations of the 2R arm
CONFIGURATIONS = 16
PRIMARY_SETS = 2
PRIMARY_2R, PRIMARY_3R = 8, 16
CONFIGURATIONS_PER_TORQUE = 4

# 4.2, Eq. 11 with q* = q1 + q2: rows [a1, a2, turns of pi] of q' = a1 q1 + a2 q2 + turns pi
PRINTED_MAPS = (
    ((1, 0, 0), (0, 1, 0)),  # q_1 = [q1, q2]
    ((1, 0, 0), (-2, -1, 0)),  # q_2 = [q1, -q* - q1]
    ((-1, 0, 0), (2, 1, 0)),  # q_3 = [-q1, q* + q1]
    ((-1, 0, 0), (0, -1, 0)),  # q_4 = [-q1, -q* + q1]
    ((1, 0, 1), (0, 1, 0)),  # q_5 = [q1 + pi, q* - q1]
    ((1, 0, 1), (-2, -1, 0)),  # q_6 = [q1 + pi, -q* - q1]
    ((-1, 0, -1), (2, 1, 0)),  # q_7 = [-q1 - pi, q* + q1]
    ((-1, 0, -1), (0, -1, 0)),  # q_8 = [-q1 - pi, -q* + q1]
)

# 4.1, Fig. 4: configurations discovered by two sequences of torque profiles
DISCOVERED = (5, 4)

# 4.3.1, Fig. 6: corners of the BCTS of the 2R arm [rad], its centre, and r
BCTS_CORNERS = (
    (0.0, 0.0),
    (math.pi / 2, -math.pi / 2),
    (math.pi / 2, math.pi / 2),
    (0.0, math.pi),
)
BCTS_CENTER = (math.pi / 4, math.pi / 4)
REDUCTION_2R, REDUCTION_WITH_SECONDARY, REDUCTION_3R = 8, 16, 16

# 7.1.1 and 7.1.2: torque ranges [N m]
TORQUES_2R = ((-18.4, 24.5), (-6.0, 6.2))
TORQUES_3R = ((-24.4, 24.0), (-24.2, 24.2), (-12.4, 12.2))

# 7.1.1: online learning of the 2R arm
SAMPLES_PER_ITERATION = 100
RMSE_66, RMSE_90, RMSE_84 = 0.0053, 0.0052, 0.0053
ITERATIONS_LLM, ITERATIONS_LLM_IT = 540, 30
FACTOR_LLM_IT = 18
LONG_ITERATIONS, LONG_RMSE = 3000, 0.0024
MINUTES_LLM, MINUTES_LLM_IT, TIME_RATIO = 0.2, 3.0, 15

# 7.1.2: online learning of the 3R arm
ITERATIONS_3R, RMSE_3R = 140, 0.26

# 7.2: lattices and networks
BATCH_2R_SAMPLES, BATCH_2R_RMSE = 255, 0.0051
PLAIN_2R_SAMPLES, PLAIN_2R_RMSE = 2040, 0.005
BATCH_3R_SAMPLES, BATCH_3R_RMSE = 65, 0.28
PLAIN_3R_SAMPLES, PLAIN_3R_RMSE = 855, 0.03
FINE_3R_SAMPLES, FINE_3R_RMSE = 600, 0.009
HIDDEN, HIDDEN_FINE = 18, 30
FACTOR_2R, FACTOR_3R = 8.0, 16.13
