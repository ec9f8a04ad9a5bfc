"""Errors are one visible line, and come back from other processes as they were raised."""

import importlib
import inspect
import pickle
import pkgutil
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

import isotorque
from isotorque.learning.learners.rigid.fitting.fit_status import FitStatus, NotAccepted
from isotorque.learning.recordings.recording_error import RecordingError
from isotorque.learning.relations.potential.errors_in_variables import Undetermined
from isotorque.symbolic.common.errors import InputError, visible
from isotorque.symbolic.gravity.gravity_model import GravityMismatch

RAISED = [
    InputError("arm.urdf", "mass of link 'hand'", -1.0, "a number >= 0 [kg]"),
    RecordingError("run.sqlite", "robot", "2r", "3r"),
    GravityMismatch("arm", "elbow", 0.25, 1e-9),
    Undetermined("12 more samples"),
    NotAccepted(FitStatus.TOO_FEW, "2 more poses"),
]
HIDDEN = st.characters(categories=["Cc", "Cf", "Zl", "Zp"])  # Cf holds what turns text around


@given(st.text(st.one_of(st.characters(codec="utf-8"), HIDDEN)))
def test_no_character_of_a_message_is_hidden(text):
    message = str(InputError(f"{text}.urdf", f"mass of link '{text}'", text, f"not {text}"))
    for shown in (message, visible(text)):
        assert shown.isprintable()
        assert not any(unicodedata.category(c) in {"Cc", "Cf", "Zl", "Zp"} for c in shown)
    assert visible(message) == message


@given(st.text(st.characters(categories=["L", "N", "P", "S"])))
def test_what_can_be_seen_is_kept(text):
    assert visible(text) == text


def test_two_texts_differ_after_escaping():
    assert visible("a\u202eb") == r"a\u202eb"
    assert visible("a\nb\x1b[2K") == r"a\nb\x1b[2K"


@pytest.mark.parametrize("error", RAISED, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling(error):
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        back = pickle.loads(pickle.dumps(error, protocol))
        assert type(back) is type(error)
        assert str(back) == str(error)
        assert vars(back) == vars(error)


def test_every_class_of_ours_is_tried():
    ours = set()
    for found in pkgutil.walk_packages(isotorque.__path__, "isotorque."):
        if found.name.endswith("__main__"):
            continue
        members = vars(importlib.import_module(found.name)).values()
        ours |= {
            m
            for m in members
            if inspect.isclass(m)
            and issubclass(m, BaseException)
            and m.__module__.split(".")[0] == "isotorque"
        }
    assert ours == {type(error) for error in RAISED}
