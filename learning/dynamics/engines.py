"""Builds the engine, or the equations of motion, that a name asks for."""

from __future__ import annotations

import pinocchio as pin

from learning.dynamics.compiled_chain import CompiledEquations
from learning.dynamics.compiled_engine import CompiledEngine
from learning.dynamics.engine import Body, Engine
from learning.dynamics.equations import Equations
from learning.dynamics.pinocchio_engine import PinocchioEngine
from learning.dynamics.pinocchio_equations import PinocchioEquations
from learning.physics import EngineName, SettleRule


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
