"""Isotorque: the statics of robot arms and their symmetries, derived, learned, verified.

All public names are here; each is imported when it is first used.

Examples
--------
>>> import isotorque as iso
>>> gravity = iso.GravityModel(iso.load_robot("2r"))
>>> group = iso.primary_symmetries(gravity.potential)
>>> group.order, group.exact
(8, True)
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from learning.arm import Arm as Arm
    from learning.arm import LimitHit as LimitHit
    from learning.arm import Outcome as Outcome
    from learning.arm import OutcomeKind as OutcomeKind
    from learning.arm import ProfileArm as ProfileArm
    from learning.arm import Settled as Settled
    from learning.arm import TimedOut as TimedOut
    from learning.discovery import discover as discover
    from learning.held_out import held_out as held_out
    from learning.learners.gaussian_process import (
        SymmetricGaussianProcess as SymmetricGaussianProcess,
    )
    from learning.learners.local_linear_map import LocalLinearMap as LocalLinearMap
    from learning.learners.network import FeedForwardNetwork as FeedForwardNetwork
    from learning.learners.recursive_least_squares import (
        RecursiveLeastSquares as RecursiveLeastSquares,
    )
    from learning.learners.static_regressor import StaticRegressor as StaticRegressor
    from learning.learners.trigonometric import EquivariantTrigonometric as EquivariantTrigonometric
    from learning.model_files import SavedModel as SavedModel
    from learning.model_files import load_model as load_model
    from learning.model_files import save_model as save_model
    from learning.recordings.csv_data import StaticSamples as StaticSamples
    from learning.recordings.csv_data import read_csv as read_csv
    from learning.recordings.recording import Recording as Recording
    from learning.relations.identification import identify as identify
    from learning.relations.relation_learning import learn_relations as learn_relations
    from learning.scheme import Scheme as Scheme
    from learning.simulation.simulated_arm import SimulatedArm as SimulatedArm
    from learning.static_torques.static_torque_set import StaticTorqueSet as StaticTorqueSet
    from symbolic.approximate_symmetries import maximal_groups as maximal_groups
    from symbolic.domain import FundamentalDomain as FundamentalDomain
    from symbolic.errors import InputError as InputError
    from symbolic.gravity import GravityModel as GravityModel
    from symbolic.kinematic_tree import KinematicTree as KinematicTree
    from symbolic.kinematic_tree import planar_arm as planar_arm
    from symbolic.relations import SymmetryGroup as SymmetryGroup
    from symbolic.relations import SymmetryRelation as SymmetryRelation
    from symbolic.robots import Robot as Robot
    from symbolic.robots import load_robot as load_robot
    from symbolic.symmetries import primary_symmetries as primary_symmetries
    from symbolic.trigonometric import TrigonometricPolynomial as TrigonometricPolynomial
    from verify.models import verify_model as verify_model
    from verify.relation_files import load_relations as load_relations
    from verify.relations import verify_relation as verify_relation
    from verify.verdict import Verdict as Verdict

__version__ = "0.1.0"

_HOME = {
    "Arm": "learning.arm",
    "EquivariantTrigonometric": "learning.learners.trigonometric",
    "FeedForwardNetwork": "learning.learners.network",
    "FundamentalDomain": "symbolic.domain",
    "GravityModel": "symbolic.gravity",
    "InputError": "symbolic.errors",
    "KinematicTree": "symbolic.kinematic_tree",
    "LimitHit": "learning.arm",
    "LocalLinearMap": "learning.learners.local_linear_map",
    "Outcome": "learning.arm",
    "OutcomeKind": "learning.arm",
    "ProfileArm": "learning.arm",
    "Recording": "learning.recordings.recording",
    "RecursiveLeastSquares": "learning.learners.recursive_least_squares",
    "Robot": "symbolic.robots",
    "SavedModel": "learning.model_files",
    "Scheme": "learning.scheme",
    "Settled": "learning.arm",
    "SimulatedArm": "learning.simulation.simulated_arm",
    "StaticRegressor": "learning.learners.static_regressor",
    "StaticSamples": "learning.recordings.csv_data",
    "StaticTorqueSet": "learning.static_torques.static_torque_set",
    "SymmetricGaussianProcess": "learning.learners.gaussian_process",
    "SymmetryGroup": "symbolic.relations",
    "SymmetryRelation": "symbolic.relations",
    "TimedOut": "learning.arm",
    "TrigonometricPolynomial": "symbolic.trigonometric",
    "Verdict": "verify.verdict",
    "discover": "learning.discovery",
    "held_out": "learning.held_out",
    "identify": "learning.relations.identification",
    "learn_relations": "learning.relations.relation_learning",
    "load_model": "learning.model_files",
    "load_relations": "verify.relation_files",
    "load_robot": "symbolic.robots",
    "maximal_groups": "symbolic.approximate_symmetries",
    "planar_arm": "symbolic.kinematic_tree",
    "primary_symmetries": "symbolic.symmetries",
    "read_csv": "learning.recordings.csv_data",
    "save_model": "learning.model_files",
    "verify_model": "verify.models",
    "verify_relation": "verify.relations",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'isotorque' has no attribute '{name}'")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
