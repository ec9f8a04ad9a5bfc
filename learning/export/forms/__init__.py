"""Torque forms: what an exported model computes, for NumPy, C and CasADi alike."""
