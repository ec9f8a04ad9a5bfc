"""The gate n_sym >= n_min: asked after target torques, and again after confirming torques."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import isotorque.learning.scheme as scheme_module
from isotorque.learning.arm import Settled
from isotorque.learning.scheme import GateDecision, Scheme, SchemeSettings


class Still:
    """An arm that settles where it is told to."""

    q = np.zeros(2)

    def apply(self, torque):
        return Settled(np.zeros(2), np.asarray(torque), 1.0)


def confirmed(monkeypatch, orders, *, passed, n_min=8, confirmations=2, missing=None):
    """The gate after confirming torques left so many relations, one after the other."""
    left = iter(orders)
    settings = SchemeSettings(n_min=n_min, confirmations=confirmations, confirm=len(orders))
    scheme = Scheme(Still(), np.random.default_rng(0), lambda group, span: None, settings)
    scheme.learned = SimpleNamespace(order=8, missing=None, decided=True)
    scheme.gates = [GateDecision(3, 8, passed, None)]
    monkeypatch.setattr(scheme_module, "next_torque", lambda *_: SimpleNamespace(torque=np.ones(2)))
    monkeypatch.setattr(
        scheme_module,
        "learn_relations",
        lambda *_, **__: SimpleNamespace(
            order=next(left), missing=missing, decided=missing is None
        ),
    )
    assert len(list(scheme._confirm())) == len(orders)
    return scheme.gate_passed


@pytest.mark.parametrize(
    ("orders", "passed", "then"),
    [
        ([8, 8], False, True),  # confirmed by torques that were chosen to contradict
        ([8], False, False),  # too few of them
        ([4, 8], False, False),  # not the same all the time
        ([8, 4], True, False),  # contradicted
        ([4, 4], True, False),
        ([8], True, True),
    ],
)
def test_confirming_torques_open_and_close_the_gate(monkeypatch, orders, passed, then):
    assert confirmed(monkeypatch, orders, passed=passed) is then


def test_what_is_missing_keeps_it_closed(monkeypatch):
    assert not confirmed(monkeypatch, [8, 8], passed=True, missing="more samples")


def test_it_is_not_asked_where_relations_are_given_or_not_used():
    make = lambda group, span: None  # noqa: E731
    rng = np.random.default_rng(0)
    assert not Scheme(Still(), rng, make).gate_passed
    assert Scheme(Still(), rng, make, use_symmetries=False).gate_passed
    assert Scheme(Still(), rng, make, group=object()).gate_passed
