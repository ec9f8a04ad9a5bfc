"""Mutations of margins, bounds and gates of the learning floor."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

IDENTIFY = "tests/learning/relations/identification/test_identify.py"

RELATIONS = (
    Mutation(
        "learning/relations/testing/supported_group.py",
        "elif p_value < level / (group.order - 1):",
        "elif p_value < level:",
        (
            "tests/learning/relations/testing/test_supported_group.py"
            "::test_each_of_many_relations_may_be_contradicted_at_its_share_of_the_level",
        ),
        "many relations are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/relations/testing/subgroup_test.py",
        "return min(1.0, min(p_values) * len(p_values)) if p_values else",
        "return min(p_values) if p_values else",
        (
            "tests/learning/relations/testing/test_supported_group.py"
            "::test_p_values_of_several_joints_together_are_small_no_more_often_than_they_say",
        ),
        "joints are tested at once (Bonferroni)",
    ),
    Mutation(
        "learning/relations/lack_of_fit.py",
        "if left and not is_clear(selection, alone):",
        "if False:",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_more_samples_are_not_asked_for_where_nothing_known_explains_the_torques",
        ),
        "samples of no arm come nearer to one with any cause",
    ),
    Mutation(
        "learning/relations/lack_of_fit.py",
        "return self.failed and bool(kinds & OF_A_CHAIN)",
        "return False and bool(kinds & OF_A_CHAIN)",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_a_wrong_sign_is_named_and_breaks_no_relation",
        ),
        "gains break no relation",
    ),
    Mutation(
        "learning/statistics/causes/selection.py",
        "return bool(other.ratio - best.ratio > stats.chi2.isf(SAYS_MORE, more))",
        "return True",
        (
            "tests/learning/statistics/causes/test_selection.py"
            "::test_what_contains_a_cause_is_told_beside_it_only_if_it_explains_more",
        ),
        "what contains a cause is compatible in any case",
    ),
    Mutation(
        "learning/relations/potential/extensible_waves.py",
        "q = samples.measured_q",
        "q = samples.q",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_a_spring_is_told_and_relations_hold_less_its_torque",
        ),
        "angles that a fit has corrected hide what it has no term for",
    ),
    Mutation(
        "learning/relations/identification/chain_identification.py",
        "return bool(kept[correction.constant != 0.0].all() and turned[springs].all())",
        "return bool(kept[correction.constant != 0.0].all())",
        (
            "tests/learning/relations/identification/test_chain_identification.py"
            "::test_springs_are_taken_off_and_relations_hold_beside_them",
        ),
        "relations that move a joint with a spring do not hold of the measured torque",
    ),
    Mutation(
        "verify/relations/verify_relation.py",
        "relation = relation.of_measured(None)",
        "relation = relation",
        (
            "tests/isotorque/runs/from_data/test_chain_from_data.py"
            "::test_a_robot_file_judges_gravity_alone",
        ),
        "a robot file has nothing beside gravity",
    ),
    Mutation(
        "learning/learners/rigid/structure/beside_chain.py",
        "springs_held = np.diag(fit.chain.correction.rate)",
        "springs_held = np.zeros((samples.n, samples.n))",
        (
            "tests/learning/relations/identification/test_chain_identification.py"
            "::test_a_spring_on_a_joint_without_gravity_leaves_no_room_for_errors_of_its_angle",
        ),
        "the rate of a spring takes up errors of its angle",
    ),
    Mutation(
        "learning/export/from_learner.py",
        "if not chain.coefficient(ColumnShape.SPRING).any():",
        "if True:",
        (
            "tests/isotorque/runs/from_data/test_chain_from_data.py"
            "::test_a_spring_becomes_part_of_the_model",
        ),
        "what is exported has the springs of the model",
    ),
    Mutation(
        "learning/learners/rigid/causes/diagnose.py",
        "weights / weights.mean() if m else weights",
        "np.ones(m)",
        ("tests/learning/learners/rigid/causes/test_diagnose.py::test_weights_count",),
        "samples of little weight name no cause",
    ),
    Mutation(
        "symbolic/groups/symmetry_group.py",
        "if relation.correction is not None:",
        "if False:",
        (
            "tests/symbolic/groups/test_symmetry_relation.py"
            "::test_corrections_that_do_not_fit_are_refused",
        ),
        "arrays of a group are applied to torques as they are",
    ),
    Mutation(
        "learning/statistics/causes/selection.py",
        "log_p = by_noise if explained else max(by_noise, log_p)",
        "log_p = by_noise",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_a_given_noise_that_is_too_small_is_said",
        ),
        "noise that was given too small is no cause",
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
        (
            "tests/learning/relations/test_claim_bounds.py"
            "::test_a_torque_that_may_be_there_is_allowed_for_on_both_sides",
        ),
        "a torque that does not follow a relation counts on both of its sides",
    ),
    Mutation(
        "learning/relations/claim_bounds.py",
        "bound = np.maximum(bound, wider)",
        "bound = np.minimum(bound, wider)",
        (
            "tests/learning/relations/test_claim_bounds.py"
            "::test_a_torque_that_may_be_there_is_allowed_for_on_both_sides",
        ),
        "bounds allow for every alternative that samples do not exclude",
    ),
    Mutation(
        "learning/relations/claim_bounds.py",
        "return np.asarray((1.0 - group.Y) * limit)",
        "return np.asarray(0.5 * (1.0 - group.Y) * limit)",
        (
            "tests/learning/relations/test_claim_bounds.py"
            "::test_a_constant_makes_relations_that_flip_it_wrong_by_twice_its_size",
        ),
        "a constant b makes a flipped torque wrong by 2 b",
    ),
)

STATISTICS = (
    Mutation(
        "learning/relations/identification/wave_identification.py",
        "    if lack.failed:\n        return",
        "    if False:\n        return",
        ("tests/learning/relations/test_lack_of_fit.py::test_a_cable_over_a_pulley_is_told",),
        "nothing is claimed where the samples show what the form has no term for",
    ),
    Mutation(
        "learning/relations/identification/wave_identification.py",
        "    if excess > 1.0:\n",
        "    if excess > 30.0:\n",
        (f"{IDENTIFY}::test_what_could_be_wrong_by_a_tenth_of_the_torque_is_not_claimed",),
        "relations that could be wrong by much are not claimed",
    ),
    Mutation(
        "learning/relations/identification/wave_identification.py",
        "SIGNIFICANCE = 1e-4",
        "SIGNIFICANCE = 1e-40",
        (f"{IDENTIFY}::test_few_stable_samples_give_the_whole_group",),
        "a group that the data contradict is not claimed",
    ),
    Mutation(
        "learning/relations/identification/wave_identification.py",
        "kept = np.flatnonzero((whole.Y[:, lack.offset_joints] > 0.0).all(axis=1))",
        "kept = np.arange(len(whole))",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_a_constant_torque_leaves_the_relations_that_do_not_flip_it",
        ),
        "relations that flip a constant torque do not hold of the measured one",
    ),
    Mutation(
        "learning/relations/identification/offset_snapping.py",
        "AGREES = 3.5",
        "AGREES = 3500.0",
        ("tests/learning/relations/identification/test_offset_snapping.py",),
        "offsets that disagree with right angles are left",
    ),
    Mutation(
        "learning/relations/identification/offset_snapping.py",
        "if (errors > SHARP).any() or",
        "if",
        ("tests/learning/relations/identification/test_offset_snapping.py",),
        "blurred offsets agree with anything",
    ),
    Mutation(
        "learning/statistics/tails.py",
        "return float(stats.t.isf(stats.norm.sf(deviations), freedom))",
        "return deviations",
        (
            "tests/learning/statistics/test_tails.py"
            "::test_quantiles_are_exceeded_as_rarely_as_those_of_a_normal_variable",
        ),
        "few degrees of freedom know the noise badly (Student)",
    ),
    Mutation(
        "learning/statistics/tails.py",
        "return float(stats.f.sf(statistic / degrees, degrees, freedom))",
        "return float(stats.chi2.sf(statistic, degrees))",
        ("tests/learning/statistics/test_tails.py::test_tail_probability_knows_its_limits",),
        "few degrees of freedom know the noise badly (F)",
    ),
    Mutation(
        "learning/relations/potential/potential_fit.py",
        "    q, tau = _different(q, tau)\n",
        "",
        ("tests/learning/relations/potential/test_potential_fit.py",),
        "samples that repeat an earlier one check nothing",
    ),
    Mutation(
        "learning/relations/testing/judge_candidates.py",
        "    if excess > 1.0:\n",
        "    if excess > 1e6:\n",
        (
            "tests/learning/relations/testing/test_judge_candidates.py"
            "::test_few_or_noisy_samples_leave_the_question_open",
        ),
        "a relation that samples could not have contradicted is not called consistent",
    ),
    Mutation(
        "learning/statistics/added_terms.py",
        "limit = np.abs(self.terms) + deviations * self.errors",
        "limit = np.abs(self.terms)",
        (
            "tests/learning/relations/test_lack_of_fit.py"
            "::test_an_alternative_may_be_as_large_as_the_samples_leave_room_for",
        ),
        "an alternative may be larger than its estimate",
    ),
    Mutation(
        "learning/learners/rigid/planning/telling_pose.py",
        "proposed = proposed[nearest[0] < nearest[1]]",
        "pass",
        (
            "tests/learning/learners/rigid/planning/test_telling_pose.py"
            "::test_what_was_refused_is_not_asked_for_again",
        ),
        "a torque that an arm did not hold is not commanded again",
    ),
    Mutation(
        "learning/statistics/added_terms.py",
        "error = hidden_effect(free) * size_left / allowed",
        "error = size_left / allowed / 4.0",
        (
            "tests/learning/statistics/test_added_terms.py"
            "::test_terms_that_are_only_bounded_are_within_their_bound",
        ),
        "terms that are only bounded may be as large as residuals leave room for",
    ),
    Mutation(
        "learning/relations/identification/wave_identification.py",
        "if any(other.bounded for other in lack.alternatives):",
        "if False:",
        (
            "tests/learning/relations/test_examined_fit.py"
            "::test_fewest_samples_with_errors_are_enough_where_sensors_are_nearly_exact",
        ),
        "what few samples hide has to be small for a claim",
    ),
    Mutation(
        "learning/relations/examined_fit.py",
        "if len(lack.alternatives) < KINDS and not _explained(fit, torques):",
        "if False:",
        ("tests/learning/relations/test_examined_fit.py",),
        "no claim from samples too few to see a spring or a cable",
    ),
    Mutation(
        "learning/relations/examined_fit.py",
        "return bool(left <= EXACT * np.abs(tau).max())",
        "return bool(left <= 1e4 * EXACT * np.abs(tau).max())",
        ("tests/learning/relations/test_examined_fit.py",),
        "few samples are exact only up to rounding",
    ),
    Mutation(
        "learning/learners/torque_score.py",
        "scale = np.where(varies, variance, variance[varies].mean())",
        "scale = np.maximum(variance, 1e-300)",
        ("tests/learning/learners/test_torque_score.py",),
        "rounding at a joint whose torque never varies costs nothing",
    ),
    Mutation(
        "learning/learners/gaussian_process/symmetric_gaussian_process.py",
        "return float(np.clip(np.median(nearest), SHORTEST, LENGTH_FOR_FEW))",
        "return SHORTEST",
        ("tests/learning/learners/gaussian_process/test_symmetric_gaussian_process.py",),
        "a length scale below the distance of the samples answers zero in between",
    ),
    Mutation(
        "isotorque/runs/run_outcome.py",
        "return not (self.gate_passed or self.options.learn_anyway)",
        "return False",
        ("tests/end_to_end/test_gate.py",),
        "nothing is learned where a gate was not passed",
    ),
    Mutation(
        "learning/statistics/causes/cause_words.py",
        '", or friction approached from one side:',
        '", and always there:',
        ("tests/learning/relations/test_lack_of_fit.py",),
        "friction from one side is not called a constant alone",
    ),
    Mutation(
        "contracts/hidden_imports.py",
        "found += list(_dynamic(module, sources))",
        "pass",
        ("tests/contracts/test_hidden_imports.py",),
        "the learner imports nothing by name",
    ),
    Mutation(
        "contracts/hidden_imports.py",
        "found += list(_borrowed(module, sources, self.forbidden_modules))",
        "pass",
        ("tests/contracts/test_hidden_imports.py",),
        "the learner takes no truth that another module imported",
    ),
    Mutation(
        "learning/learners/cross_validation.py",
        "folds = poses.count if poses.count <= LEAVE_ONE_OUT else FOLDS",
        "folds = FOLDS",
        ("tests/learning/learners/test_cross_validation.py",),
        "few poses are left out one by one",
    ),
    Mutation(
        "learning/learners/cross_validation.py",
        "part = (rng.permutation(poses.count) % folds)[poses.label]",
        "part = rng.permutation(len(samples)) % folds",
        ("tests/learning/learners/test_cross_validation.py",),
        "rows of one pose share a part",
    ),
    Mutation(
        "learning/statistics/poses.py",
        "CHANCE = 1e-4",
        "CHANCE = 1.0",
        ("tests/learning/statistics/test_poses.py",),
        "rows that nobody repeated are not taken for repeated ones",
    ),
    Mutation(
        "learning/statistics/extrapolation.py",
        "return not self.predicted <= WILD * self.seen",
        "return not self.predicted <= 100 * WILD * self.seen",
        (
            "tests/learning/statistics/test_extrapolation.py"
            "::test_answers_beyond_twice_the_largest_torque_are_wild_and_said",
        ),
        "wild answers beyond the data are said",
    ),
    Mutation(
        "learning/relations/pairing/a_contrario_test.py",
        "MOST_ROW_ALARMS = -1.0",
        "MOST_ROW_ALARMS = 100.0",
        ("tests/learning/relations/pairing/test_a_contrario_test.py",),
        "chance explains no row of a relation found by pairs",
    ),
)

DISCOVERY = (
    Mutation(
        "learning/discovery/torque_profiles.py",
        'bc_type="clamped"',
        'bc_type="not-a-knot"',
        ("tests/learning/discovery/test_torque_profiles.py",),
        "profiles begin and end with zero derivatives",
    ),
    Mutation(
        "learning/discovery/torque_profile_discovery.py",
        "signs = ending if settled else np.ones_like(tau)",
        "signs = np.ones_like(tau)",
        (
            "tests/learning/discovery/test_torque_profile_discovery.py"
            "::test_each_profile_starts_where_the_last_one_ended",
        ),
        "a profile starts where the last one ended",
    ),
    Mutation(
        "learning/discovery/torque_profile_discovery.py",
        "np.all(np.abs(wrap(q - p)) < settings.same_angle) for p in found",
        "False for p in found",
        (
            "tests/learning/discovery/test_torque_profile_discovery.py"
            "::test_a_configuration_is_new_once_whatever_its_turns_and_its_last_digits",
        ),
        "configurations seen before are not new ones",
    ),
)

MUTATIONS = (*RELATIONS, *STATISTICS, *DISCOVERY)
