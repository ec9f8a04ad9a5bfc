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

MUTATIONS = (*RELATIONS, *MODELS, *REPORTS)
