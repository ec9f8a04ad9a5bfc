"""Engines and equations of motion by name."""

from __future__ import annotations

import pinocchio as pin

from isotorque.learning.simulator.compiled.chain import CompiledEquations
from isotorque.learning.simulator.compiled.engine import CompiledEngine
from isotorque.learning.simulator.dynamics.engine import Body, Engine
from isotorque.learning.simulator.dynamics.equations import Equations
from isotorque.learning.simulator.reference.engine import PinocchioEngine
from isotorque.learning.simulator.reference.equations import PinocchioEquations
from isotorque.learning.simulator.settings import EngineName, SettleRule


def new_equations(engine: EngineName, model: pin.Model) -> Equations:
    """Return the equations of motion that an engine uses."""
    if engine is EngineName.PINOCCHIO:
        return PinocchioEquations(model)
    return CompiledEquations(model)


def new_engine(engine: EngineName, model: pin.Model, body: Body, rule: SettleRule) -> Engine:
    """Return an engine for the model of a robot (nq = nv = number of joints)."""
    if engine is EngineName.PINOCCHIO:
        return PinocchioEngine(model, body, rule)
    return CompiledEngine(model, body, rule)
