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
    from learning.export.c_export import c_source as c_source
    from learning.export.casadi_export import casadi_function as casadi_function
    from learning.export.from_learner import torque_form as torque_form
    from learning.held_out import held_out as held_out
    from learning.learners.gaussian_process import (
        SymmetricGaussianProcess as SymmetricGaussianProcess,
    )
    from learning.learners.local_linear_map import LocalLinearMap as LocalLinearMap
    from learning.learners.network import FeedForwardNetwork as FeedForwardNetwork
    from learning.learners.recursive_least_squares import (
        RecursiveLeastSquares as RecursiveLeastSquares,
    )
    from learning.learners.rigid.rigid_chain import RigidChain as RigidChain
    from learning.learners.static_regressor import StaticRegressor as StaticRegressor
    from learning.learners.trigonometric import EquivariantTrigonometric as EquivariantTrigonometric
    from learning.model_files import SavedModel as SavedModel
    from learning.model_files import load_model as load_model
    from learning.model_files import save_model as save_model
    from learning.recordings.csv_data import StaticSamples as StaticSamples
    from learning.recordings.csv_data import read_csv as read_csv
    from learning.recordings.recording import Recording as Recording
    from learning.relations.broken_symmetries import SupportedGroup as SupportedGroup
    from learning.relations.broken_symmetries import supported_group as supported_group
    from learning.relations.candidate_maps import judge_candidates as judge_candidates
    from learning.relations.identification import identify as identify
    from learning.relations.relation_learning import learn_relations as learn_relations
    from learning.sampling.lattice import lattice_samples as lattice_samples
    from learning.sampling.optimal_design import Design as Design
    from learning.sampling.optimal_design import d_optimal as d_optimal
    from learning.sampling.optimal_design import least_variance as least_variance
    from learning.sampling.sampling_region import SamplingRegion as SamplingRegion
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
    from verify.static_torques import judge_static_torques as judge_static_torques
    from verify.verdict import Verdict as Verdict

__version__ = "0.1.0"

_HOME = {
    "Arm": "learning.arm",
    "Design": "learning.sampling.optimal_design",
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
    "RigidChain": "learning.learners.rigid.rigid_chain",
    "Robot": "symbolic.robots",
    "SamplingRegion": "learning.sampling.sampling_region",
    "SavedModel": "learning.model_files",
    "Scheme": "learning.scheme",
    "Settled": "learning.arm",
    "SimulatedArm": "learning.simulation.simulated_arm",
    "StaticRegressor": "learning.learners.static_regressor",
    "StaticSamples": "learning.recordings.csv_data",
    "StaticTorqueSet": "learning.static_torques.static_torque_set",
    "SupportedGroup": "learning.relations.broken_symmetries",
    "SymmetricGaussianProcess": "learning.learners.gaussian_process",
    "SymmetryGroup": "symbolic.relations",
    "SymmetryRelation": "symbolic.relations",
    "TimedOut": "learning.arm",
    "TrigonometricPolynomial": "symbolic.trigonometric",
    "Verdict": "verify.verdict",
    "c_source": "learning.export.c_export",
    "casadi_function": "learning.export.casadi_export",
    "d_optimal": "learning.sampling.optimal_design",
    "discover": "learning.discovery",
    "held_out": "learning.held_out",
    "identify": "learning.relations.identification",
    "judge_candidates": "learning.relations.candidate_maps",
    "judge_static_torques": "verify.static_torques",
    "lattice_samples": "learning.sampling.lattice",
    "learn_relations": "learning.relations.relation_learning",
    "least_variance": "learning.sampling.optimal_design",
    "load_model": "learning.model_files",
    "load_relations": "verify.relation_files",
    "load_robot": "symbolic.robots",
    "maximal_groups": "symbolic.approximate_symmetries",
    "planar_arm": "symbolic.kinematic_tree",
    "primary_symmetries": "symbolic.symmetries",
    "read_csv": "learning.recordings.csv_data",
    "save_model": "learning.model_files",
    "supported_group": "learning.relations.broken_symmetries",
    "torque_form": "learning.export.from_learner",
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
