"""Static samples of arms whose truth is known, for the tests of relation learning."""

import numpy as np

from isotorque.symbolic.common.angles import wrap
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.groups.symmetry_group import SymmetryGroup
from isotorque.symbolic.level_sets.level_set import level_set
from isotorque.symbolic.polynomials.trigonometric_polynomial import TrigonometricPolynomial
from isotorque.symbolic.robots.load_robot import load_robot
from isotorque.symbolic.symmetries.primary_symmetries import primary_symmetries


def known_potential(name: str) -> tuple[TrigonometricPolynomial, SymmetryGroup]:
    """Gravity potential and exact group of a built-in robot."""
    potential = GravityModel(load_robot(name)).potential
    return potential.to_float(), primary_symmetries(potential)


def stable_samples(potential, rng, count):
    """Configurations an arm without a controller can rest at, and their torques."""
    acting = potential.frequencies.any(axis=0)
    found = np.empty((0, potential.n))
    while len(found) < count:
        q = rng.uniform(-np.pi, np.pi, (40 * count, potential.n))
        stiffness = potential.hessian(q)[:, acting][:, :, acting]
        found = np.concatenate([found, q[np.linalg.eigvalsh(stiffness).min(axis=1) > 1e-6]])
    return found[:count], potential.gradient(found[:count])


def recording(potential, group, rng, torques, *, kept=(0.3, 0.6), smallest_share=0.05):
    """Level sets of random torques, each configuration kept with a probability drawn from `kept`.

    Free joints take any angle.
    """
    scale = np.abs(potential.gradient(rng.uniform(-np.pi, np.pi, (2000, potential.n)))).max(axis=0)
    probability = rng.uniform(*kept)
    free = group.free_directions
    q, tau = [], []
    while len(q) < torques:
        torque = potential.gradient(rng.uniform(-np.pi, np.pi, potential.n))
        if (np.abs(torque) < smallest_share * scale).any():
            continue
        found = level_set(potential, torque, group=group, max_starts=400)
        chosen = rng.random(len(found)) < probability
        if chosen.any():
            moved = rng.uniform(-np.pi, np.pi, (int(chosen.sum()), len(free))) @ free
            q.append(wrap(found.configurations[chosen] + moved))
            tau.append(found.torques[chosen])
    return np.concatenate(q), np.concatenate(tau)


def with_angle_noise(q, degrees, rng):
    """Angles measured with independent normal errors."""
    return q + np.deg2rad(degrees) * rng.normal(size=q.shape)


def worst_torque_error(relation, potential, rng, probes=300):
    """Largest |g_i(A q + d) - Y_i g_i(q)| over random q, for each joint."""
    q = rng.uniform(-np.pi, np.pi, (probes, potential.n))
    image = potential.gradient(relation.configuration(q))
    return np.abs(image - relation.torque(potential.gradient(q))).max(axis=0)


def same_group(learned, true, angle):
    """Whether two groups have the same relations, offsets to within `angle` [rad]."""
    return learned.order == true.order and all(
        any(relation.same_as(other, angle) for other in true) for relation in learned
    )


def false_relations(learned, true, angle):
    """Relations of a learned group that the true one does not have."""
    return [r for r in learned if not any(r.same_as(other, angle) for other in true)]
