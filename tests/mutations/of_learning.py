"""Mutations of margins, bounds and gates of the learning floor."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

RELATIONS = (
    Mutation(
        "learning/relations/testing/supported_group.py",
        "elif p_value < level / (group.order - 1):",
        "elif p_value < level:",
        ("tests/learning/relations/testing/test_supported_group.py",),
        "many relations are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/relations/testing/subgroup_test.py",
        "return min(1.0, min(p_values) * len(p_values)) if p_values else",
        "return min(p_values) if p_values else",
        ("tests/learning/relations/testing/test_supported_group.py",),
        "joints are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/statistics/lack_of_fit.py",
        "if worst is not None and worst.p_value < SIGNIFICANCE / len(found):",
        "if worst is not None and worst.p_value < SIGNIFICANCE:",
        ("tests/learning/statistics/test_lack_of_fit.py",),
        "alternatives are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/statistics/lack_of_fit.py",
        "seen = (chance < SIGNIFICANCE / max(1, len(joints)))",
        "seen = (chance < SIGNIFICANCE)",
        ("tests/learning/statistics/test_lack_of_fit.py",),
        "constants of all joints are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/relations/identification/group_fit.py",
        "limit[~pulled[:m].any(axis=1)] *= 2.0",
        "limit[~pulled[:m].any(axis=1)] *= 1.0",
        ("tests/learning/relations/identification/test_group_fit.py",),
        "a term that only one side of a relation has counts on both",
    ),
    Mutation(
        "learning/relations/identification/group_fit.py",
        "bound[i] = limit @ size",
        "bound[i] = 0.5 * limit @ size",
        ("tests/learning/relations/identification/test_group_fit.py",),
        "halved bounds of learned relations",
    ),
    Mutation(
        "learning/relations/claim_bounds.py",
        "wider[i] += np.where(kept, 0.0, 2.0 * other.size)",
        "wider[i] += np.where(kept, 0.0, other.size)",
        ("tests/learning/statistics/test_lack_of_fit.py",),
        "a torque that does not follow a relation counts on both of its sides",
    ),
    Mutation(
        "learning/relations/claim_bounds.py",
        "bound = np.maximum(bound, wider)",
        "bound = np.minimum(bound, wider)",
        ("tests/learning/statistics/test_lack_of_fit.py",),
        "bounds allow for every alternative that samples do not exclude",
    ),
    Mutation(
        "learning/relations/claim_bounds.py",
        "return np.asarray((1.0 - group.Y) * limit)",
        "return np.asarray(0.5 * (1.0 - group.Y) * limit)",
        ("tests/learning/statistics/test_lack_of_fit.py",),
        "a constant b makes a flipped torque wrong by 2 b",
    ),
)

DISCOVERY = (
    Mutation(
        "learning/discovery/torque_profiles.py",
        'bc_type="clamped"',
        'bc_type="not-a-knot"',
        ("tests/learning/discovery/test_torque_profile_discovery.py",),
        "profiles begin and end with zero derivatives",
    ),
    Mutation(
        "learning/discovery/torque_profile_discovery.py",
        "signs = ending if settled else np.ones_like(tau)",
        "signs = np.ones_like(tau)",
        ("tests/learning/discovery/test_torque_profile_discovery.py",),
        "a profile starts where the last one ended",
    ),
    Mutation(
        "learning/discovery/torque_profile_discovery.py",
        "np.all(np.abs(wrap(q - p)) < settings.same_angle) for p in found",
        "False for p in found",
        ("tests/learning/discovery/test_torque_profile_discovery.py",),
        "configurations seen before are not new ones",
    ),
)

MUTATIONS = (*RELATIONS, *DISCOVERY)
