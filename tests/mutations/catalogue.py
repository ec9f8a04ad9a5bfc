"""All mutations, floor by floor."""

from __future__ import annotations

from tests.mutations import of_learning, of_motion, of_rigid_chains, of_symbolic, of_verify
from tests.mutations.mutation import Mutation

MUTATIONS: tuple[Mutation, ...] = (
    *of_symbolic.MUTATIONS,
    *of_learning.MUTATIONS,
    *of_rigid_chains.MUTATIONS,
    *of_motion.MUTATIONS,
    *of_verify.MUTATIONS,
)
