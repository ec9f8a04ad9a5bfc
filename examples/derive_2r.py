"""Derive the gravity torque of a planar two-link arm in symbols and compare with the textbook.

python examples/derive_2r.py
"""

import math

import sympy

from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.gravity.readable import gravity_latex, gravity_sympy, gravity_text
from isotorque.symbolic.robots.kinematic_tree import planar_arm
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

# Masses m1, m2, lengths l1, l2, centres of mass c1, c2 and g are SymPy symbols.
gravity = GravityModel(planar_arm(2))
print(gravity_text(gravity))

# Siciliano et al., Robotics (2009), section 7.3.2, without the rotors' masses.
m1, m2, l1, c1, c2, g = sympy.symbols("m1 m2 l1 c1 c2 g", positive=True)
q1, q2 = sympy.symbols("q1 q2", real=True)
textbook = sympy.Matrix(
    [
        (m1 * c1 + m2 * l1) * g * sympy.cos(q1) + m2 * c2 * g * sympy.cos(q1 + q2),
        m2 * c2 * g * sympy.cos(q1 + q2),
    ]
)
difference = (gravity_sympy(gravity, (q1, q2)) - textbook).expand()
print("difference to the textbook:", list(difference))
if any(difference):
    raise SystemExit(1)

print(gravity_latex(gravity))

# Numbers may be put in at any time: two uniform rods of 5 kg and 0.25 m.
rods = {"m1": 5, "m2": 5, "l1": 0.25, "c1": 0.125, "c2": 0.125, "g": 9.81}
numeric = GravityModel(planar_arm(2).substitute(rods))
print("torque stretched out to the right [N m]:", numeric.torque([0.0, 0.0]))
print("stiffness hanging down [N m/rad]:", numeric.stiffness([-math.pi / 2, 0.0]).tolist())

# The symmetries hold for all masses and lengths: they are derived from the symbols.
group = primary_symmetries(gravity.potential)
print(f"{group.order} relations g(A q + d) = Y g(q):")
for relation in group:
    print("  A", relation.A.tolist(), "d", relation.d.round(4).tolist(), "Y", relation.Y.tolist())
