"""Mutations of proofs, bounds and checks of the symbolic floor."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

EXACT = "tests/symbolic/symmetries/test_exact_symmetries.py"
PHASES = "tests/symbolic/symmetries/test_phase_proof.py"
RESIDUAL = "tests/symbolic/symmetries/test_residual_bound.py"
AVERAGE = "tests/symbolic/symmetries/test_reynolds_average.py"
LEVEL_SET = "tests/symbolic/level_sets/test_level_set.py"
RELATION = "tests/symbolic/groups/test_symmetry_relation.py"

SYMMETRIES = (
    Mutation(
        "symbolic/symmetries/phase_proof.py",
        "        if not self.complete:\n            return False\n",
        "",
        (EXACT, PHASES),
        "the completeness guard itself",
    ),
    Mutation(
        "symbolic/symmetries/exact_symmetries.py",
        "complete = int(kept.sum()) == int(np.any(numeric.frequencies, axis=1).sum())",
        "complete = True",
        (EXACT,),
        "a term left out may be all of another block of joints",
    ),
    Mutation(
        "symbolic/symmetries/exact_symmetries.py",
        "RELATIVE = 1e-12",
        "RELATIVE = 1e-6",
        (EXACT,),
        "amplitudes that differ by a millionth would count as equal",
    ),
    Mutation(
        "symbolic/symmetries/phase_proof.py",
        "if np.any((self.exponents @ w - quarter) % 4):",
        "if np.any((self.exponents @ w - quarter) % 2):",
        (PHASES,),
        "congruences of right angles hold modulo four of them, not two",
        equivalent="where all u_k are powers of i, the float check of d behind it sees every "
        "violation too: it is a right angle, not a rounding; the exact check stays, as a proof "
        "should not rest on floats",
    ),
    Mutation(
        "symbolic/symmetries/phase_proof.py",
        "        if any(x * x + y * y != 1 for x, y in u):\n            return False\n",
        "",
        (PHASES,),
        "amplitudes must be equal exactly",
    ),
    Mutation(
        "symbolic/symmetries/phase_proof.py",
        "return all(_product(w, row) == v for row, v in "
        "zip(self.exponents.tolist(), u, strict=True))",
        "return True",
        (PHASES,),
        "phases must respect every integer relation of the frequencies",
    ),
    Mutation(
        "symbolic/symmetries/phase_proof.py",
        "return bool(np.all(np.abs(misfit) < 1e-9))",
        "return True",
        (PHASES,),
        "the offset must be one of the exact ones, not of another coset",
    ),
    Mutation(
        "symbolic/symmetries/residual_bound.py",
        "return 2 * np.abs(total).sum(axis=0)",
        "return np.abs(total).sum(axis=0)",
        (RESIDUAL,),
        "halved bounds of relations that are not exact",
    ),
    Mutation(
        "symbolic/symmetries/reynolds_average.py",
        "return np.asarray(2 * np.abs(own - average) @ np.abs(K))",
        "return np.asarray(np.abs(own - average) @ np.abs(K))",
        (AVERAGE,),
        "halved distance to the symmetric potential",
    ),
    Mutation(
        "symbolic/symmetries/approximate_symmetries.py",
        "error = 2 * symmetric_part_error(potential, support.B, A_sat, d_sat, Y)",
        "error = symmetric_part_error(potential, support.B, A_sat, d_sat, Y)",
        (AVERAGE,),
        "a relation errs by twice the distance to the symmetric potential: at q and at its image",
    ),
    Mutation(
        "symbolic/symmetries/approximate_symmetries.py",
        "verdicts[members] = error <= tolerance",
        "verdicts[members] = error <= 2 * tolerance",
        (AVERAGE,),
        "no relation of a group found with a tolerance errs by more",
    ),
    Mutation(
        "symbolic/groups/symmetry_relation.py",
        "self.bound + other.bound,",
        "np.maximum(self.bound, other.bound),",
        (RELATION,),
        "errors of composed relations add up",
    ),
    Mutation(
        "symbolic/groups/symmetry_relation.py",
        "self.exact and other.exact,",
        "self.exact or other.exact,",
        (RELATION,),
        "a product is exact if both factors are",
    ),
    Mutation(
        "symbolic/symmetries/product_group.py",
        "exact = all(part.exact for part in parts)",
        "exact = any(part.exact for part in parts)",
        (
            "tests/symbolic/symmetries/test_product_group.py"
            "::test_a_relation_is_exact_only_if_it_is_on_every_block",
        ),
        "a relation is exact if it is on every block",
    ),
)

ROBOTS = (
    Mutation(
        "symbolic/robots/snap_effect.py",
        "own = np.linalg.norm(first.rotations - second.rotations, ord=2, axis=(1, 2)) + 2 * axis",
        "own = np.linalg.norm(first.rotations - second.rotations, ord=2, axis=(1, 2)) + axis",
        (
            "tests/symbolic/robots/test_snap_effect.py"
            "::test_half_a_turn_about_an_axis_off_by_s_tilts_gravity_by_twice_that",
        ),
        "turning about axes that differ by s differs by up to 2 s",
    ),
    Mutation(
        "symbolic/robots/snap_effect.py",
        "moved[parent] += moved[i] + steps[i] + own[i] * moments[i]",
        "moved[parent] += moved[i] + own[i] * moments[i]",
        ("tests/symbolic/robots/test_snap_effect.py",),
        "longer links move the masses behind them",
    ),
    Mutation(
        "symbolic/robots/snap_effect.py",
        "@ np.abs(difference) + neglected",
        "@ np.abs(difference)",
        ("tests/symbolic/robots/test_snap_effect.py",),
        "what is left out of a bound is added to it",
    ),
    Mutation(
        "symbolic/robots/snap_effect.py",
        "turned[i] = own[i] + (turned[parent] if parent >= 0 else turned[i])",
        "turned[i] = own[i]",
        ("tests/symbolic/robots/test_snap_effect.py",),
        "turns of the joints before a joint add up",
    ),
    Mutation(
        "symbolic/robots/body_checks.py",
        "SMALLEST_MASS = 1e-12",
        "SMALLEST_MASS = 0.0",
        ("tests/symbolic/robots/test_body_checks.py",),
        "arms too light for floats are refused by their mass, not by what underflows",
    ),
    Mutation(
        "symbolic/robots/snapping.py",
        "SNAP_ANGLE = 1e-5",
        "SNAP_ANGLE = 1e-3",
        ("tests/symbolic/robots/test_snapping.py",),
        "angles that were meant are not snapped",
    ),
    Mutation(
        "symbolic/robots/snapping.py",
        "> ROUNDING",
        "> 1e-6",
        ("tests/symbolic/robots/test_snapping.py", "tests/symbolic/robots/test_snapped_bodies.py"),
        "every snap is listed with its effect",
    ),
    Mutation(
        "symbolic/common/joint_limits.py",
        "if lower == upper == 0:",
        "if lower == 0 or upper == 0:",
        ("tests/symbolic/common/test_joint_limits.py",),
        "limits of 0 to x are limits",
    ),
    Mutation(
        "symbolic/robots/urdf/urdf_elements.py",
        'if joint.kind in ("revolute", "prismatic") and (lower or upper):',
        'if joint.kind in ("revolute", "prismatic") and (lower and upper):',
        ("tests/symbolic/robots/urdf/test_urdf_file.py",),
        "limits of 0 to x are read",
    ),
    Mutation(
        "symbolic/robots/mass_plausibility.py",
        "if missing and not feels_gravity(body) and feels_gravity(_filled(body)):",
        "if False:",
        ("tests/symbolic/robots/test_mass_plausibility.py",),
        "an arm without masses is refused",
    ),
    Mutation(
        "symbolic/gravity/gravity_model.py",
        "return _ROUNDING * _torque_scale(self.tree) + float(np.finfo(float).tiny)",
        "return _ROUNDING * 100.0",
        ("tests/scales/test_groups.py", "tests/symbolic/gravity/test_gravity_model.py"),
        "rounding is in proportion to masses, lengths and gravity: arms of hardly any torque too",
    ),
    Mutation(
        "symbolic/gravity/gravity_model.py",
        "allowed = self._reference.snap_bound + rounding",
        "allowed = 2 * self._reference.snap_bound + 1e6 * rounding",
        ("tests/symbolic/gravity/test_gravity_model.py",),
        "a torque that is not Pinocchio's is refused",
    ),
    Mutation(
        "symbolic/gravity/gravity_model.py",
        "self._potential_error = self._check(self.potential.gradient)",
        "self._potential_error = 0.0",
        (
            "tests/symbolic/gravity/test_gravity_model.py"
            "::test_each_of_both_forms_is_checked_by_itself",
        ),
        "the potential, which proofs are about, is checked against Pinocchio",
    ),
    Mutation(
        "symbolic/gravity/gravity_model.py",
        "        self._check(chain.torque)\n",
        "",
        (
            "tests/symbolic/gravity/test_gravity_model.py"
            "::test_each_of_both_forms_is_checked_by_itself",
        ),
        "the recursion, which numbers come from, is checked against Pinocchio",
    ),
)

LEVEL_SETS_AND_DOMAINS = (
    Mutation(
        "symbolic/level_sets/equations.py",
        "one[close] = miss <= self.accuracy",
        "one[close] = True",
        (f"{LEVEL_SET}::test_configurations_close_to_a_fold_are_two",),
        "configurations near each other are two unless what lies between them solves as well",
    ),
    Mutation(
        "symbolic/level_sets/level_set.py",
        "stable=np.all(stiffness > least, axis=1),",
        "stable=np.all(stiffness > -least, axis=1),",
        ("tests/symbolic/level_sets/test_level_set.py",),
        "a configuration without stiffness does not hold itself",
    ),
    Mutation(
        "symbolic/level_sets/level_set.py",
        "complete = len(equations.targets) == 0",
        "complete = True",
        ("tests/symbolic/level_sets/test_level_set.py",),
        "a search proves nothing complete",
    ),
    Mutation(
        "symbolic/level_sets/newton_search.py",
        "HITS = 6",
        "HITS = 1",
        (f"{LEVEL_SET}::test_no_search_ends_before_every_set_was_reached_several_times",),
        "every set is reached several times before a search ends",
    ),
    Mutation(
        "symbolic/domains/dirichlet_cell.py",
        "if 2 * reach <= radius or radius >= largest:",
        "if reach <= radius or radius >= largest:",
        (
            "tests/symbolic/domains/test_dirichlet_cell.py::test_slender_cells_have_their_volume_too",
        ),
        "images up to twice the circumradius bound a cell",
    ),
    Mutation(
        "symbolic/domains/dirichlet_cell.py",
        "if len(nearest) and length[nearest[0]] < LEAST_SEPARATION:",
        "if False:",
        (
            "tests/symbolic/domains/test_dirichlet_cell.py",
            "tests/symbolic/domains/test_fundamental_domain.py",
        ),
        "a centre that a relation fixes makes no domain",
    ),
    Mutation(
        "symbolic/domains/canonical_representatives.py",
        "keep = points[:, coordinate] >= best[ways[:, 0]] - SAME_COORDINATE",
        "keep = points[:, coordinate] >= -np.inf",
        ("tests/symbolic/domains/test_canonical_representatives.py",),
        "one representative per orbit, on the boundary too",
    ),
)

MUTATIONS = (*SYMMETRIES, *ROBOTS, *LEVEL_SETS_AND_DOMAINS)
