"""The mutations still apply to the source, and the tests that must kill them exist."""

from tests.mutations.catalogue import MUTATIONS
from tests.mutations.run import share_of, stale


def test_no_mutation_is_stale():
    """If this fails, a guard was rewritten: let the mutation break it where it stands now."""
    assert stale(MUTATIONS) == []


def test_there_are_enough_of_them_and_none_twice():
    assert len(MUTATIONS) >= 60
    assert len({(m.file, m.original, m.mutated) for m in MUTATIONS}) == len(MUTATIONS)
    floors = {m.file.split("/")[0] for m in MUTATIONS}
    assert floors == {"symbolic", "learning", "verify", "isotorque", "contracts"}


def test_each_says_what_it_guards_and_who_must_notice():
    for mutation in MUTATIONS:
        assert mutation.why
        assert mutation.tests


def test_one_seed_chooses_one_share():
    some = share_of(MUTATIONS, 0.1, seed=3)
    assert len(some) == -(-len(MUTATIONS) // 10)
    assert some == share_of(MUTATIONS, 0.1, seed=3)
    assert some != share_of(MUTATIONS, 0.1, seed=4)
    assert share_of(MUTATIONS, 1.0, seed=5) == list(MUTATIONS)
