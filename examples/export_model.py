"""Learn the gravity torque of a two-link arm and hand it to a controller as C source.

python examples/export_model.py gravity.c
cc -O2 -c gravity.c                     # examples/call_gravity.c calls it
"""

import sys
from pathlib import Path

import numpy as np

from isotorque.learning.export.c_export import c_source
from isotorque.learning.export.casadi_export import casadi_function
from isotorque.learning.export.from_learner import torque_form
from isotorque.learning.learners.network.feed_forward_network import FeedForwardNetwork
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries

robot = load_robot("2r")
gravity = GravityModel(robot)
q = np.random.default_rng(0).uniform(-np.pi, np.pi, (40, robot.n))
network = FeedForwardNetwork(hidden=8, group=primary_symmetries(gravity.potential))
network.fit(q, gravity.torque(q))

# Whatever was learned becomes tables and one formula, from which all else is written.
form = torque_form(network)
print("learned:", form.KIND, "with", form.hidden.size + form.output.size, "numbers")

about = [f"Learned by {type(network).__name__} on {robot.name}, robot {robot.digest[:12]}"]
source = c_source(form, about, robot.joint_names)
if len(sys.argv) > 1:
    Path(sys.argv[1]).write_text(source)
print("C:", len(source.splitlines()), "lines")

function = casadi_function(form)
difference = np.abs(np.array(function(q[0])).ravel() - network.predict(q[:1])[0]).max()
print("CasADi:", function, "equals predict:", bool(difference < 1e-12))
print("torque error [N m]:", f"{np.abs(network.predict(q) - gravity.torque(q)).max():.1e}")
