"""Mutations of proofs, bounds and verdicts of the verification floor."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

RELATION = "tests/verify/relations/test_verify_relation.py"
PROOF = "tests/verify/relations/test_exact_proof.py"
BOUNDS = "tests/verify/relations/test_ball_bounds.py"
CLAIMS = "tests/verify/relations/test_relations_file_claims.py"
MODEL = "tests/verify/models/test_verify_model.py"

RELATIONS = (
    Mutation(
        "verify/relations/ball_bounds.py",
        "bound[i] = bound[i] + abs(weight) * size",
        "bound[i] = bound[i] + abs(weight) * size / 2",
        (BOUNDS,),
        "halved bounds of learned maps",
    ),
    Mutation(
        "verify/relations/residual.py",
        "total[i] = total[i] + abs(acb(c, s))",
        "total[i] = total[i] + abs(acb(c, s)) / 2",
        (BOUNDS,),
        "halved bounds of relations",
    ),
    Mutation(
        "verify/relations/ball_bounds.py",
        "min(2.0, upper(turned))",
        "min(1.0, upper(turned))",
        (BOUNDS,),
        "a wave changes by up to twice its amplitude",
    ),
    Mutation(
        "verify/relations/verify_relation.py",
        "if np.equal(images, np.round(images)).all(axis=1).any():",
        "if False:",
        (RELATION,),
        "a bound for every q is computed where waves may cancel",
    ),
    Mutation(
        "verify/relations/exact_numbers.py",
        "with ctx.workprec(PRECISION_BITS + bits):",
        "with ctx.workprec(PRECISION_BITS):",
        ("tests/verify/relations/test_exact_numbers.py",),
        "angles of many turns are reduced with enough digits",
    ),
    Mutation(
        "verify/relations/residual.py",
        "return all(abs(x) <= SLOW * self.divisor for f in self.waves for x in f)",
        "return True",
        (RELATION,),
        "waves too fast for floats are searched exactly",
    ),
    Mutation(
        "verify/relations/exact_proof.py",
        "OFFSET_ROUNDING = 2.0**-51",
        "OFFSET_ROUNDING = 1e-9",
        (PROOF,),
        "an offset that is no rounding of an exact one is not proved",
    ),
    Mutation(
        "verify/relations/exact_proof.py",
        "            if current[1] != ONE:\n                return None\n",
        "            pass\n",
        (PROOF,),
        "phases respect every integer relation of the frequencies",
    ),
    Mutation(
        "verify/relations/exact_proof.py",
        "if image is None or image[0] * image[0] + image[1] * image[1] != norm:",
        "if image is None:",
        (PROOF,),
        "amplitudes are equal exactly",
    ),
    Mutation(
        "verify/relations/exact_numbers.py",
        "< 2**62:  # neither does a sum",
        "< 2**80:  # neither does a sum",
        ("tests/verify/relations/test_exact_numbers.py",),
        "products of machine integers do not overflow",
    ),
    Mutation(
        "verify/relations/verify_relation.py",
        "return Verdict(words, Status.TESTED, largest)",
        "return Verdict(words, Status.BOUNDED, largest)",
        (RELATION,),
        "what is neither bounded nor refuted is only tested",
    ),
    Mutation(
        "verify/relations/verify_relation.py",
        "    if excess > gravity.rounding:\n",
        "    if excess > 1e9 * gravity.rounding:\n",
        (RELATION,),
        "what is proved of the potential is held against the recursion",
    ),
    Mutation(
        "verify/relations/verify_relation.py",
        "stands = proof.holds or bool(np.all(bound <= allowed))",
        "stands = proof.holds or bool(np.any(bound <= allowed))",
        (RELATION,),
        "every joint is within the tolerance",
    ),
    Mutation(
        "verify/relations/relations_file_claims.py",
        "        if verdict.status is Status.TESTED:\n            status = Status.TESTED\n",
        "",
        (CLAIMS,),
        "a claim about bounds of which one was only tested is only tested",
    ),
    Mutation(
        "verify/relations/relations_file_claims.py",
        "return len({group.index(relation) for relation in listed}) == len(listed)",
        "return True",
        (CLAIMS,),
        "a relation listed twice completes no list",
    ),
    Mutation(
        "verify/relations/relations_file_claims.py",
        "whole = whole and all(_proved(relation, gravity.potential) for relation in file)",
        "",
        (CLAIMS,),
        "a list is complete if its relations are proved",
    ),
    Mutation(
        "verify/relations/learned_symmetries.py",
        "SAME_RELATION = 0.2",
        "SAME_RELATION = 2.0",
        ("tests/verify/relations/test_learned_symmetries.py",),
        "a relation far from every true one is false",
    ),
)

MODELS = (
    Mutation(
        "verify/models/verify_model.py",
        "fails = bool(np.any(result.rmse_by_joint > allowed))",
        "fails = bool(np.all(result.rmse_by_joint > allowed))",
        (MODEL,),
        "a model is right at every joint",
    ),
    Mutation(
        "verify/models/verify_model.py",
        "fails = bool(np.any(excess > 0))",
        "fails = bool(np.all(excess > 0))",
        (MODEL,),
        "the largest error is judged at every joint",
    ),
    Mutation(
        "verify/models/verify_model.py",
        "regions = [(replace(measured(dense), largest_by_joint=largest), worst)]",
        "regions = [(measured(dense), worst)]",
        (MODEL,),
        "the largest error is that of a search, not of a set",
    ),
)

REPORTS = (
    Mutation(
        "isotorque/runs/judgement.py",
        "run.steps, run.scheme.group, run.scheme.settings.exploration.step_width\n",
        "run.steps, run.scheme.group\n",
        ("tests/isotorque/cli/test_run.py::test_the_report_holds_what_was_learned_and_judged",),
        "the share of the domain that is explored says within which distance",
    ),
    Mutation(
        "verify/report/summaries.py",
        "explored_radius=radius if shares else None,",
        "explored_radius=None,",
        ("tests/isotorque/cli/test_run.py::test_the_report_holds_what_was_learned_and_judged",),
        "the share of the domain that is explored says within which distance",
    ),
)

FRESH = "learning/statistics/fresh_errors.py"
MEASURED = "verify/models/fresh_measurements.py"
MEASURED_RELATIONS = "verify/relations/measured_relations.py"
RELATION_ERRORS = "learning/relations/testing/relation_errors.py"
OF_FRESH = ("tests/learning/statistics/test_fresh_errors.py",)
OF_MEASURED = ("tests/verify/models/test_fresh_measurements.py",)
OF_MEASURED_RELATIONS = ("tests/verify/relations/test_measured_relations.py",)
OF_RELATION_ERRORS = ("tests/learning/relations/testing/test_relation_errors.py",)

BY_MEASUREMENTS = (
    Mutation(
        "verify/verdict.py",
        "not in (Status.REFUTED, Status.UNTESTED)",
        "is not Status.REFUTED",
        ("tests/verify/test_verdict.py",),
        "what was not tested passes",
    ),
    Mutation(
        FRESH,
        "return float(degrees * ratio)",
        "return 1.0",
        OF_FRESH,
        "noise that was estimated is taken for known: right models are refuted too often",
    ),
    Mutation(
        FRESH,
        "return float(freedom / special.chdtri(freedom, MISSED / 2.0))",
        "return 1.0",
        OF_FRESH,
        "noise that was estimated too large hides errors of three times the tolerance",
    ),
    Mutation(
        FRESH,
        "return square / total, total**2 / square",
        "return total / len(variance), float(len(variance))",
        OF_FRESH,
        "poses of few rows are as sure as the others",
    ),
    Mutation(
        MEASURED,
        "elif hidden.any():",
        "elif False:",
        OF_MEASURED,
        "noise that hides errors passes",
    ),
    Mutation(
        MEASURED,
        "elif (fresh.span < ALIKE).all():",
        "elif False:",
        OF_MEASURED,
        "poses all alike pass",
    ),
    Mutation(
        MEASURED,
        "if self.poses.count < LEAST_POSES:",
        "if False:",
        OF_MEASURED,
        "one pose judges a model",
    ),
    Mutation(
        MEASURED,
        "found.freedom >= FEW_REPEATS",
        "found.freedom < 0",
        OF_MEASURED,
        "what a model states goes before what the measurements show",
    ),
    Mutation(
        MEASURED_RELATIONS,
        "found.poses >= LEAST_POSES and found.resolved.all()",
        "found.poses and found.resolved.all()",
        OF_MEASURED_RELATIONS,
        "a pair of poses lets a relation pass",
    ),
    Mutation(
        MEASURED_RELATIONS,
        "and found.resolved.all()",
        "and True",
        OF_MEASURED_RELATIONS,
        "pairs in much noise let a relation pass",
    ),
    Mutation(
        MEASURED_RELATIONS,
        "(best.most <= RESOLVED * self.allowed).all()",
        "True",
        OF_MEASURED_RELATIONS,
        "a fit that tells nothing lets a relation pass",
    ),
    Mutation(
        MEASURED_RELATIONS,
        "if (errors.seen > self.allowed).any():",
        "if False:",
        OF_MEASURED_RELATIONS,
        "a relation that the fit misses passes, because a spring might be there",
    ),
    Mutation(
        RELATION_ERRORS,
        "np.abs(miss) - deviations * more - 2.0 * other.size",
        "np.abs(missed) - deviations * error",
        OF_MEASURED_RELATIONS,
        "relations are refuted though a cable might be what is seen",
    ),
    Mutation(
        RELATION_ERRORS,
        "if carried.any():",
        "if False:",
        OF_RELATION_ERRORS,
        "joints that never moved are carried to where nothing was measured",
    ),
    Mutation(
        RELATION_ERRORS,
        '(examined.lack.left if noise is None else "") or ',
        "",
        OF_RELATION_ERRORS,
        "samples in degrees are taken for noisy ones",
    ),
    Mutation(
        "isotorque/runs/verification.py",
        "verdicts += of_robot if data is None else _named(of_robot, gravity)",
        "verdicts += of_robot",
        ("tests/isotorque/runs/test_verification.py",),
        "nobody knows which claims are about the arm and which about its drawing",
    ),
)

MUTATIONS = (*RELATIONS, *MODELS, *REPORTS, *BY_MEASUREMENTS)
