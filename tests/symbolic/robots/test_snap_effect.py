"""Bounds on the difference of two arms' gravity torques: never exceeded, and tight."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.gravity.potential import derive_potential
from isotorque.symbolic.robots.arm_body import ArmBody
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.robots.snap_effect import (
    _by_coefficients,
    _by_lengths,
    torque_difference_bound,
)
from isotorque.symbolic.robots.urdf.urdf_file import urdf_text
from tests.symbolic.robots.urdf.urdf_strategies import urdfs

PER_JOINT = [field.name for field in fields(ArmBody)][2:-1]


def body_of(urdf) -> ArmBody:
    return ArmBody.from_model(pin.buildModelFromXML(urdf_text(urdf)), "arm")


def disturbed(body: ArmBody, rng: np.random.Generator, size: float) -> ArmBody:
    """The arm with every rotation, axis and length changed a little."""
    turn = np.array([pin.exp3(size * rng.normal(size=3)) for _ in range(body.n)])
    axes = body.axes + size * rng.normal(size=(body.n, 3))
    return replace(
        body,
        rotations=turn @ body.rotations,
        axes=axes / np.linalg.norm(axes, axis=1)[:, None],
        translations=body.translations + size * rng.normal(size=(body.n, 3)),
        levers=body.levers + size * rng.normal(size=(body.n, 3)),
        masses=body.masses * (1 + size * rng.normal(size=body.n)),
    )


def gravity(body: ArmBody, q: np.ndarray) -> np.ndarray:
    model = body.to_model("arm")
    data = model.createData()
    return np.array([pin.computeGeneralizedGravity(model, data, row).copy() for row in q])


@given(urdfs(), st.integers(0, 2**32), st.sampled_from([1e-6, 1e-3, 0.3]))
def test_both_bounds_hold_and_the_smaller_one_is_given(urdf, seed, size):
    rng = np.random.default_rng(seed)
    first = body_of(urdf)
    second = disturbed(first, rng, size)
    q = rng.uniform(-np.pi, np.pi, (50, first.n))
    seen = np.abs(gravity(first, q) - gravity(second, q)).max(axis=0)
    coefficients = _by_coefficients(first.tree(), second.tree())
    lengths = _by_lengths(first.tree(), second.tree())
    assert np.all(seen <= coefficients + 1e-12)
    assert np.all(seen <= lengths + 1e-12)
    bound = torque_difference_bound(first.tree(), second.tree())
    np.testing.assert_array_equal(bound, np.minimum(coefficients, lengths))


@pytest.mark.parametrize("field", ["rotations", "axes", "translations", "levers", "masses"])
@given(seed=st.integers(0, 2**32))
@settings(max_examples=10)
def test_each_kind_of_difference_alone_is_bounded(field, seed):
    rng = np.random.default_rng(seed)
    first = ArmBody.from_model(load_robot("panda").model, "panda")
    second = replace(first, **{field: getattr(disturbed(first, rng, 1e-3), field)})
    q = rng.uniform(-np.pi, np.pi, (100, first.n))
    seen = np.abs(gravity(first, q) - gravity(second, q)).max(axis=0)
    for bound in (_by_coefficients, _by_lengths):
        limit = bound(first.tree(), second.tree())
        assert np.all(seen <= limit + 1e-12)
        assert np.all(limit <= 3.0)  # a few times 1e-3 of 60 Nm for each of seven joints


@given(urdfs(max_joints=4), st.integers(0, 2**32))
def test_the_bound_by_coefficients_is_that_of_the_exact_potentials(urdf, seed):
    first = body_of(urdf)
    second = disturbed(first, np.random.default_rng(seed), 1e-4)
    difference = derive_potential(first.tree()) - derive_potential(second.tree())
    np.testing.assert_allclose(
        _by_coefficients(first.tree(), second.tree()),
        difference.to_float().gradient_bound(),
        atol=1e-11,
    )


def test_what_is_left_out_of_the_coefficients_is_in_the_bound(monkeypatch):
    """With a coarse threshold the coefficients alone would promise too much."""
    first = ArmBody.from_model(load_robot("panda").model, "panda")
    rng = np.random.default_rng(0)
    second = disturbed(first, rng, 0.3)
    q = rng.uniform(-np.pi, np.pi, (300, 7))
    seen = np.abs(gravity(first, q) - gravity(second, q)).max(axis=0)
    monkeypatch.setattr("isotorque.symbolic.robots.snap_effect._NEGLIGIBLE", 0.9)
    assert np.all(seen <= _by_coefficients(first.tree(), second.tree()))


def test_an_arm_does_not_differ_from_itself():
    body = ArmBody.from_model(load_robot("panda").model, "panda")
    assert not np.any(torque_difference_bound(body.tree(), body.tree()))


@pytest.mark.parametrize("field", ["rotations", "axes"])
def test_a_long_chain_is_bounded_too(field):
    """Twenty joints in all directions have 3^20 frequencies: bounded by lengths."""
    rng = np.random.default_rng(1)
    panda = ArmBody.from_model(load_robot("panda").model, "panda")
    repeat = [0, 1, 2, 3, 4, 5, 6] * 3
    body = ArmBody(
        joint_names=tuple(f"joint{i}" for i in range(20)),
        parents=tuple(range(-1, 19)),
        **{name: getattr(panda, name)[repeat[:20]] for name in PER_JOINT},
        gravity=panda.gravity,
    )
    other = replace(body, **{field: getattr(disturbed(body, rng, 1e-6), field)})
    q = rng.uniform(-np.pi, np.pi, (200, 20))
    seen = np.abs(gravity(body, q) - gravity(other, q)).max(axis=0)
    bound = torque_difference_bound(body.tree(), other.tree())
    assert np.all(seen <= bound)
    assert np.all(bound < 0.1)


@given(st.floats(1e-9, 0.3), st.floats(-np.pi, np.pi), st.floats(0.1, 10.0))
@settings(max_examples=25)
def test_half_a_turn_about_an_axis_off_by_s_tilts_gravity_by_twice_that(s, direction, mass):
    """A vertical axis and a hanging load behind it: the torque reaches what the bound says."""
    upright = ArmBody(
        joint_names=("turn", "lift"),
        parents=(-1, 0),
        rotations=np.array([np.eye(3)] * 2),
        translations=np.zeros((2, 3)),
        axes=np.array([[0.0, 0.0, 1.0], [np.sin(direction), -np.cos(direction), 0.0]]),
        masses=np.array([1.0, mass]),
        levers=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -0.5]]),
        inertias=np.array([np.eye(3)] * 2),
        limits=np.array([[-np.pi, np.pi]] * 2),
        efforts=np.full(2, np.inf),
        velocities=np.full(2, np.inf),
        damping=np.zeros(2),
        friction=np.zeros(2),
        armature=np.zeros(2),
        gravity=np.array([0.0, 0.0, -9.81]),
    )
    axes = upright.axes.copy()
    axes[0] = [np.sin(s) * np.cos(direction), np.sin(s) * np.sin(direction), np.cos(s)]
    tilted = replace(upright, axes=axes)
    half_a_turn = np.array([[np.pi, 0.0]])
    seen = np.abs(gravity(upright, half_a_turn) - gravity(tilted, half_a_turn))[0]
    np.testing.assert_allclose(seen[1], 0.5 * mass * 9.81 * np.sin(2 * s), rtol=1e-5)
    for bound in (_by_lengths, _by_coefficients, torque_difference_bound):
        assert np.all(seen <= bound(upright.tree(), tilted.tree()) * (1 + 1e-7) + 1e-14)
