"""Mutations of what makes a rigid chain accepted, and of what is claimed of it."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

RIGID = "learning/learners/rigid"
TESTS = "tests/learning/learners/rigid"
ACCEPTANCE = f"{TESTS}/fitting/test_acceptance.py"
SNAPPING = f"{TESTS}/structure/test_snapping.py"
SYMMETRIES = f"{TESTS}/structure/test_chain_symmetries.py"

MUTATIONS = (
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "LEAST_LIKELY = 1e-4",
        "LEAST_LIKELY = 0.0",
        (f"{ACCEPTANCE}::test_noise_is_accepted_as_large_as_it_was_stated",),
        "a misfit larger than the stated noise is refused",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "    if not _known_elsewhere(result):\n",
        "    if False:\n",
        (f"{ACCEPTANCE}::test_accepted_chains_know_more_of_the_torque_elsewhere_than_its_size",),
        "a chain whose torque elsewhere is open is not accepted, noise stated",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "                if _known_elsewhere(result):\n",
        "                if True:\n",
        (f"{ACCEPTANCE}::test_a_chain_whose_torque_elsewhere_is_open_is_not_accepted",),
        "a chain whose torque elsewhere is open is not accepted, noise estimated",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "RIVAL_COST = 30.0",
        "RIVAL_COST = -1.0",
        (f"{ACCEPTANCE}::test_chains_that_fit_as_well_and_differ_elsewhere_are_rivals",),
        "chains that explain the samples equally well and differ elsewhere are rivals",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "if result.degrees < 1 or not error < KNOWN_EVERYWHERE * fit.samples.largest_torque:",
        "if result.degrees < 1:",
        (
            f"{ACCEPTANCE}::test_a_chain_whose_torque_elsewhere_is_open_is_not_accepted",
            f"{ACCEPTANCE}::test_equal_poses_and_a_joint_that_never_moves_are_refused",
        ),
        "exact samples determine a chain everywhere, or it is not accepted",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "if firm < model.n or samples.poses < poses_needed(model) + 1:",
        "if False:",
        (f"{ACCEPTANCE}::test_with_noise_as_many_equations_are_to_spare_as_there_are_joints",),
        "with noise as many equations must be to spare as there are joints",
    ),
    Mutation(
        f"{RIGID}/fitting/acceptance.py",
        "HELD_OUT_SHARE = 0.05",
        "HELD_OUT_SHARE = 0.5",
        (f"{ACCEPTANCE}::test_a_chain_that_misses_a_tenth_of_the_torque_is_no_model",),
        "a chain predicts poses that were left out, or is not accepted",
    ),
    Mutation(
        f"{RIGID}/planning/poses_needed.py",
        "return -(-(most_parameters(model) + 1) // model.n)",
        "return -(-most_parameters(model) // model.n)",
        (f"{TESTS}/planning/test_poses_needed.py",),
        "one equation more than parameters checks a chain",
    ),
    Mutation(
        f"{RIGID}/fitting/noise_estimate.py",
        "kept = samples.part(~out)",
        "kept = samples",
        (f"{ACCEPTANCE}::test_a_chain_whose_torque_elsewhere_is_open_is_not_accepted",),
        "what is left out is left out",
    ),
    Mutation(
        f"{RIGID}/structure/snapping.py",
        "if growth < self._threshold and self._tenable(found.cost):",
        "if self._tenable(found.cost):",
        (f"{SNAPPING}::test_nothing_is_set_that_its_own_test_contradicts",),
        "a right angle is set if the likelihood ratio allows it (angles)",
    ),
    Mutation(
        f"{RIGID}/structure/snapping.py",
        "if growth >= self._threshold or not self._tenable(found.cost):",
        "if not self._tenable(found.cost):",
        (f"{SNAPPING}::test_nothing_is_set_that_its_own_test_contradicts",),
        "a lever is dropped if the likelihood ratio allows it",
    ),
    Mutation(
        f"{RIGID}/structure/snapping.py",
        "stats.norm.ppf(POWER))",
        "stats.norm.ppf(1.0 - POWER))",
        (f"{SNAPPING}::test_what_would_have_been_seen_is_seen_as_often_as_stated",),
        "what would have been seen is told, with the power of the test",
    ),
    Mutation(
        f"{RIGID}/structure/chain_symmetries.py",
        "DEVIATIONS = 3.0",
        "DEVIATIONS = 0.3",
        (f"{SYMMETRIES}::test_bounds_hold_for_arms_that_are_not_as_special_as_they_look",),
        "bounds allow for three standard errors",
    ),
    Mutation(
        f"{RIGID}/structure/chain_symmetries.py",
        "least = np.abs(self._special.gains) * proved",
        "least = 0.0 * proved",
        (f"{SYMMETRIES}::test_a_tolerance_adds_relations_that_nearly_hold",),
        "what a relation of a tolerance errs by is part of its bound",
    ),
    Mutation(
        f"{RIGID}/planning/standard_errors.py",
        "return np.maximum(linear, fit.spread * np.sqrt(np.mean(changes**2, axis=0)))",
        "return 0.5 * linear",
        (f"{TESTS}/test_rigid_chain.py::test_standard_errors_are_calibrated",),
        "standard errors are as large as errors",
    ),
    Mutation(
        f"{RIGID}/fitting/chain_fit.py",
        "return float(stats.t.isf(stats.norm.sf(3.0), freedom)) / 3.0",
        "return 1.0",
        (f"{ACCEPTANCE}::test_errors_are_widened_where_the_noise_was_estimated",),
        "errors are larger where the noise was estimated (Student)",
    ),
    Mutation(
        f"{RIGID}/planning/information.py",
        "np.where(open_part > least, np.inf, known)",
        "known",
        (f"{TESTS}/planning/test_information.py",),
        "torques that samples leave open have infinite errors",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "if excess > 1.0:",
        "if False:",
        (
            "tests/learning/relations/identification/test_chain_identification.py"
            "::test_no_relation_is_claimed_that_could_be_wrong_by_a_twentieth",
        ),
        "relations that could be wrong by much are not claimed",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "if learner.shown_causes():",
        "if False:",
        ("tests/learning/relations/identification/test_chain_identification.py",),
        "a constant that passes for noise makes relations false",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "if not beside.complete and",
        "if False and",
        (
            "tests/learning/relations/identification/test_chain_identification.py"
            "::test_samples_too_few_to_show_a_spring_are_not_enough_unless_they_are_exact",
        ),
        "samples too few to show a spring do not prove that there is none",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "if given < min(needed, len(torques)):",
        "if False:",
        (
            "tests/learning/relations/identification/test_identify.py"
            "::test_many_images_of_few_torques_do_not_make_a_chain",
        ),
        "many images of few torques determine no chain",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "if joint is not None:",
        "if False:",
        (
            "tests/isotorque/cli/test_relations.py"
            "::test_bad_recordings_get_an_answer_that_says_what_is_missing",
        ),
        "a link that was balanced at all samples may have a lever",
    ),
    Mutation(
        "learning/relations/identification/identify.py",
        "if whole.p_value < SIGNIFICANCE:",
        "if False:",
        (
            "tests/learning/relations/identification/test_identify.py"
            "::test_waves_veto_what_a_chain_takes_for_noise",
        ),
        "waves have a veto on the relations of a chain",
    ),
    Mutation(
        "learning/learners/rigid/structure/beside_chain.py",
        "return np.where(follows, 0.0, 2.0 * self.largest)",
        "return np.zeros(len(Y))",
        (
            "tests/learning/relations/identification/test_chain_identification.py"
            "::test_bounds_hold_for_torques_that_hide_in_the_noise",
        ),
        "bounds allow for torques that hide in the noise",
    ),
    Mutation(
        "learning/learners/rigid/rigid_chain.py",
        "if not kinds or not kinds <= HELD or not rivals <= HELD | ROOM_FOR:",
        "if not kinds:",
        ("tests/learning/relations/identification/test_chain_identification.py",),
        "springs and cables are no constants",
    ),
    Mutation(
        "learning/statistics/causes/selection.py",
        "least = np.log(min(LATER, level) if choices else level) - np.log(tried)",
        "least = np.log(min(LATER, level) if choices else level)",
        ("tests/learning/statistics/causes/test_selection.py",),
        "the level is that of all candidates together",
    ),
    Mutation(
        "learning/statistics/causes/selection.py",
        "if again.cost < fit.cost and again.plausible():",
        "if False:",
        ("tests/learning/statistics/causes/test_selection.py",),
        "a model alone is fitted again from the chains of the best candidates",
    ),
    Mutation(
        "learning/statistics/causes/linear_model.py",
        "if self.stiffness_of is None:",
        "if True:",
        ("tests/learning/learners/rigid/causes/test_beside_gravity.py",),
        "errors of angles are told from constants beside a regressor",
    ),
    Mutation(
        "learning/learners/rigid/causes/beside_gravity.py",
        "np.where(np.arange(len(q))[:, None, None] < term.place, 0.0, own)",
        "0.0 * own",
        ("tests/learning/learners/rigid/causes/test_beside_gravity.py",),
        "a model is of the arm before its payload changed",
    ),
    Mutation(
        "learning/statistics/causes/candidates.py",
        "loaded &= size > CARRYING * noise",
        "loaded = size > -1.0",
        ("tests/learning/statistics/causes/test_candidates.py",),
        "gains of joints without torque turn noise into features",
    ),
)
