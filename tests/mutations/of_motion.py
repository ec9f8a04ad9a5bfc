"""Mutations of limits, settling, exploration, recordings and exports."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

STRATEGIES = "tests/learning/exploration/test_strategies.py"
SETTLING = "tests/learning/simulator/reference/test_engine.py"
FILES = "tests/symbolic/common/test_files.py"

LIMITS_AND_SETTLING = (
    Mutation(
        "learning/discovery/torque_limits.py",
        "np.clip(wanted, -self._largest, self._largest)",
        "np.clip(wanted, -np.inf, self._largest)",
        ("tests/learning/discovery/test_torque_limits.py",),
        "motors are limited in both directions",
    ),
    Mutation(
        "learning/discovery/torque_limits.py",
        "if abs(value) > most:",
        "if value > most:",
        ("tests/learning/discovery/test_torque_limits.py",),
        "a torque beyond a limit is refused in both directions",
    ),
    Mutation(
        "learning/simulator/reference/engine.py",
        "return q if definite and inside.all() else None",
        "return q if inside.all() else None",
        (SETTLING,),
        "an unstable equilibrium is no place to settle",
    ),
    Mutation(
        "learning/simulator/reference/engine.py",
        "return q if definite and inside.all() else None",
        "return q if definite else None",
        (SETTLING,),
        "an equilibrium beyond a limit is no place to settle",
    ),
    Mutation(
        "learning/simulator/reference/engine.py",
        "        if largest(v) > self._rule.velocity:\n            return False\n",
        "",
        (SETTLING,),
        "a moving arm has not settled",
    ),
    Mutation(
        "learning/simulator/reference/engine.py",
        "if t - quiet_since >= rule.dwell - TIME_ROUNDING:",
        "if True:",
        (SETTLING,),
        "an arm has settled when it was quiet for a while",
    ),
)

EXPLORATION = (
    Mutation(
        "learning/exploration/static_projection.py",
        "SAFE_SHARE = 0.7",
        "SAFE_SHARE = 1.3",
        ("tests/learning/exploration/test_static_projection.py",),
        "torques stay inside what is known to hold",
    ),
    Mutation(
        "learning/exploration/exploration.py",
        "self._static_torques.mark_inadmissible(outcome.torque)",
        "pass",
        (f"{STRATEGIES}::test_limits_are_marked_and_not_learned",),
        "a torque that did not hold is not tried again",
    ),
    Mutation(
        "learning/exploration/exploration.py",
        "learned = settled or self.settings.learn_inadmissible",
        "learned = True",
        (f"{STRATEGIES}::test_limits_are_marked_and_not_learned",),
        "where the arm did not settle there is no static sample",
    ),
    Mutation(
        "learning/exploration/exploration.py",
        "self._below >= self.settings.windows_below and share >= self.settings.required_share",
        "self._below >= self.settings.windows_below",
        (f"{STRATEGIES}::test_does_not_stop_before_the_domain_is_explored",),
        "a small error where the arm has been says nothing of where it has not",
    ),
    Mutation(
        "learning/static_torques/static_torque_set.py",
        "nearer = to_held < to_refused",
        "nearer = to_held < np.inf",
        ("tests/learning/static_torques/test_static_torque_set.py",),
        "torques near one that failed are not admitted",
    ),
)

RECORDINGS_AND_EXPORTS = (
    Mutation(
        "learning/recordings/database/commit_log.py",
        'execute("rollback")',
        'execute("commit")',
        ("tests/learning/recordings/database/test_commit_log.py",),
        "a commit that fails leaves nothing behind",
    ),
    Mutation(
        "learning/recordings/database/schema.py",
        "where excluded.number >= number and excluded.checksum != checksum",
        "where excluded.checksum != checksum",
        (
            "tests/learning/recordings/test_recorded_arm.py"
            "::test_a_checkpoint_of_a_replay_does_not_replace_a_later_one",
        ),
        "a checkpoint of a replay does not replace a later one",
    ),
    Mutation(
        "learning/recordings/database/writer_lock.py",
        "fcntl.LOCK_EX | fcntl.LOCK_NB",
        "fcntl.LOCK_SH | fcntl.LOCK_NB",
        (
            "tests/learning/recordings/failures/test_refused_files.py"
            "::test_a_second_writer_in_the_same_process",
        ),
        "a recording has one writer",
    ),
    Mutation(
        "learning/recordings/database/damage_check.py",
        "if checksum(*row[:-1]) != row[-1]:",
        "if False:",
        (
            "tests/learning/recordings/failures/test_refused_files.py"
            "::test_damage_is_refused_or_harmless",
        ),
        "a flipped bit of a number is noticed",
    ),
    Mutation(
        "learning/recordings/database/damage_check.py",
        "or last[part] != count - 1:",
        "or False:",
        ("tests/learning/recordings/database/test_damage_check.py",),
        "a missing command is noticed",
    ),
    Mutation(
        "symbolic/common/files.py",
        "Path(name).replace(path)",
        "path.write_bytes(Path(name).read_bytes())",
        (FILES,),
        "no reader sees half of a file",
    ),
    Mutation(
        "symbolic/common/files.py",
        "Path(name).unlink(missing_ok=True)",
        "pass",
        (FILES,),
        "a file that could not be written leaves nothing behind",
    ),
    Mutation(
        "learning/export/forms/torque_form.py",
        "return float(np.abs(evaluate(form, q) - predict(q).reshape(CHECKS, -1)).max(initial=0.0))",
        "return 0.0",
        ("tests/learning/export/forms/test_torque_form.py",),
        "an export is held against its model",
    ),
    Mutation(
        "learning/export/forms/torque_form.py",
        "q = np.random.default_rng(0).uniform(-np.pi, np.pi, (CHECKS, form.joints))",
        "q = np.zeros((CHECKS, form.joints))",
        ("tests/learning/export/forms/test_torque_form.py",),
        "... all over the space",
    ),
    Mutation(
        "learning/export/c_export.py",
        "if form.outputs != form.joints:",
        "if False:",
        ("tests/learning/export/test_c_export.py",),
        "a controller gets one torque per joint",
    ),
)

MUTATIONS = (*LIMITS_AND_SETTLING, *EXPLORATION, *RECORDINGS_AND_EXPORTS)
