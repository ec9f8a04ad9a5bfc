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

from isotorque.symbolic.common.version import VERSION

if TYPE_CHECKING:
    from isotorque.learning.arm import Arm as Arm
    from isotorque.learning.arm import LimitHit as LimitHit
    from isotorque.learning.arm import Outcome as Outcome
    from isotorque.learning.arm import OutcomeKind as OutcomeKind
    from isotorque.learning.arm import ProfileArm as ProfileArm
    from isotorque.learning.arm import Settled as Settled
    from isotorque.learning.arm import TimedOut as TimedOut
    from isotorque.learning.discovery.torque_profile_discovery import discover as discover
    from isotorque.learning.export.c_export import c_source as c_source
    from isotorque.learning.export.casadi_export import casadi_function as casadi_function
    from isotorque.learning.export.from_learner import torque_form as torque_form
    from isotorque.learning.files.csv_samples import read_csv as read_csv
    from isotorque.learning.files.saved_models import SavedModel as SavedModel
    from isotorque.learning.files.saved_models import load_model as load_model
    from isotorque.learning.files.saved_models import save_model as save_model
    from isotorque.learning.files.static_samples import StaticSamples as StaticSamples
    from isotorque.learning.learners.cross_validation import cross_validate as cross_validate
    from isotorque.learning.learners.gaussian_process.symmetric_gaussian_process import (
        SymmetricGaussianProcess as SymmetricGaussianProcess,
    )
    from isotorque.learning.learners.local_linear.local_linear_map import (
        LocalLinearMap as LocalLinearMap,
    )
    from isotorque.learning.learners.local_linear.recursive_least_squares import (
        RecursiveLeastSquares as RecursiveLeastSquares,
    )
    from isotorque.learning.learners.network.feed_forward_network import (
        FeedForwardNetwork as FeedForwardNetwork,
    )
    from isotorque.learning.learners.rigid.equivariant_trigonometric import (
        EquivariantTrigonometric as EquivariantTrigonometric,
    )
    from isotorque.learning.learners.rigid.process.rigid_chain_process import (
        RigidChainProcess as RigidChainProcess,
    )
    from isotorque.learning.learners.rigid.rigid_chain import RigidChain as RigidChain
    from isotorque.learning.learners.rigid.static_regressor import (
        StaticRegressor as StaticRegressor,
    )
    from isotorque.learning.recordings.recording import Recording as Recording
    from isotorque.learning.relations.identification.identify import identify as identify
    from isotorque.learning.relations.learn_relations import learn_relations as learn_relations
    from isotorque.learning.relations.testing.judge_candidates import (
        judge_candidates as judge_candidates,
    )
    from isotorque.learning.relations.testing.supported_group import (
        SupportedGroup as SupportedGroup,
    )
    from isotorque.learning.relations.testing.supported_group import (
        supported_group as supported_group,
    )
    from isotorque.learning.sampling.lattice import lattice_samples as lattice_samples
    from isotorque.learning.sampling.optimal_design import Design as Design
    from isotorque.learning.sampling.optimal_design import d_optimal as d_optimal
    from isotorque.learning.sampling.optimal_design import least_variance as least_variance
    from isotorque.learning.sampling.sampling_region import SamplingRegion as SamplingRegion
    from isotorque.learning.scheme import Scheme as Scheme
    from isotorque.learning.simulator.simulated_arm import SimulatedArm as SimulatedArm
    from isotorque.learning.static_torques.static_torque_set import (
        StaticTorqueSet as StaticTorqueSet,
    )
    from isotorque.symbolic.common.errors import InputError as InputError
    from isotorque.symbolic.domains.fundamental_domain import FundamentalDomain as FundamentalDomain
    from isotorque.symbolic.gravity.gravity_model import GravityModel as GravityModel
    from isotorque.symbolic.groups.symmetry_group import SymmetryGroup as SymmetryGroup
    from isotorque.symbolic.groups.symmetry_relation import SymmetryRelation as SymmetryRelation
    from isotorque.symbolic.polynomials.trigonometric_polynomial import (
        TrigonometricPolynomial as TrigonometricPolynomial,
    )
    from isotorque.symbolic.robots.kinematic_tree import KinematicTree as KinematicTree
    from isotorque.symbolic.robots.kinematic_tree import planar_arm as planar_arm
    from isotorque.symbolic.robots.load_robot import Robot as Robot
    from isotorque.symbolic.robots.load_robot import load_robot as load_robot
    from isotorque.symbolic.symmetries.approximate_symmetries import (
        maximal_groups as maximal_groups,
    )
    from isotorque.symbolic.symmetries.primary_symmetries import (
        primary_symmetries as primary_symmetries,
    )
    from isotorque.verify.models.verify_model import verify_model as verify_model
    from isotorque.verify.relations.relation_files import load_relations as load_relations
    from isotorque.verify.relations.verify_relation import verify_relation as verify_relation
    from isotorque.verify.static_torques.judge_static_torques import (
        judge_static_torques as judge_static_torques,
    )
    from isotorque.verify.verdict import Verdict as Verdict

__version__ = VERSION

_HOME = {
    "Arm": "learning.arm",
    "Design": "learning.sampling.optimal_design",
    "EquivariantTrigonometric": "learning.learners.rigid.equivariant_trigonometric",
    "FeedForwardNetwork": "learning.learners.network.feed_forward_network",
    "FundamentalDomain": "symbolic.domains.fundamental_domain",
    "GravityModel": "symbolic.gravity.gravity_model",
    "InputError": "symbolic.common.errors",
    "KinematicTree": "symbolic.robots.kinematic_tree",
    "LimitHit": "learning.arm",
    "LocalLinearMap": "learning.learners.local_linear.local_linear_map",
    "Outcome": "learning.arm",
    "OutcomeKind": "learning.arm",
    "ProfileArm": "learning.arm",
    "Recording": "learning.recordings.recording",
    "RecursiveLeastSquares": "learning.learners.local_linear.recursive_least_squares",
    "RigidChain": "learning.learners.rigid.rigid_chain",
    "RigidChainProcess": "learning.learners.rigid.process.rigid_chain_process",
    "Robot": "symbolic.robots.load_robot",
    "SamplingRegion": "learning.sampling.sampling_region",
    "SavedModel": "learning.files.saved_models",
    "Scheme": "learning.scheme",
    "Settled": "learning.arm",
    "SimulatedArm": "learning.simulator.simulated_arm",
    "StaticRegressor": "learning.learners.rigid.static_regressor",
    "StaticSamples": "learning.files.static_samples",
    "StaticTorqueSet": "learning.static_torques.static_torque_set",
    "SupportedGroup": "learning.relations.testing.supported_group",
    "SymmetricGaussianProcess": "learning.learners.gaussian_process.symmetric_gaussian_process",
    "SymmetryGroup": "symbolic.groups.symmetry_group",
    "SymmetryRelation": "symbolic.groups.symmetry_relation",
    "TimedOut": "learning.arm",
    "TrigonometricPolynomial": "symbolic.polynomials.trigonometric_polynomial",
    "Verdict": "verify.verdict",
    "c_source": "learning.export.c_export",
    "casadi_function": "learning.export.casadi_export",
    "d_optimal": "learning.sampling.optimal_design",
    "discover": "learning.discovery.torque_profile_discovery",
    "cross_validate": "learning.learners.cross_validation",
    "identify": "learning.relations.identification.identify",
    "judge_candidates": "learning.relations.testing.judge_candidates",
    "judge_static_torques": "verify.static_torques.judge_static_torques",
    "lattice_samples": "learning.sampling.lattice",
    "learn_relations": "learning.relations.learn_relations",
    "least_variance": "learning.sampling.optimal_design",
    "load_model": "learning.files.saved_models",
    "load_relations": "verify.relations.relation_files",
    "load_robot": "symbolic.robots.load_robot",
    "maximal_groups": "symbolic.symmetries.approximate_symmetries",
    "planar_arm": "symbolic.robots.kinematic_tree",
    "primary_symmetries": "symbolic.symmetries.primary_symmetries",
    "read_csv": "learning.files.csv_samples",
    "save_model": "learning.files.saved_models",
    "supported_group": "learning.relations.testing.supported_group",
    "torque_form": "learning.export.from_learner",
    "verify_model": "verify.models.verify_model",
    "verify_relation": "verify.relations.verify_relation",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'isotorque' has no attribute '{name}'")
    value = getattr(importlib.import_module(f"isotorque.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
