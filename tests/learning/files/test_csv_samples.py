"""CSV files of static samples: exact round trips, clear words about everything else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isotorque.learning.files.csv_samples import joint_names_of, read_csv, write_csv
from isotorque.learning.files.static_samples import StaticSamples
from isotorque.symbolic.common.errors import InputError

MEASURED = st.floats(-1e9, 1e9)
JOINTS = ("shoulder", "elbow, left", 'wrist "3"')


@st.composite
def samples_of(draw):
    m, n = draw(st.integers(1, 6)), draw(st.integers(1, 3))
    q, tau = (draw(arrays(np.float64, (m, n), elements=MEASURED)) for _ in range(2))
    tau[0, 0] = draw(st.sampled_from([1.0, -1e-12, 1e9]))  # not all are next to nothing
    return StaticSamples(q, tau), JOINTS[:n]


@given(samples_of())
def test_written_samples_read_back_bit_for_bit(tmp_path_factory, drawn):
    samples, joints = drawn
    path = tmp_path_factory.mktemp("csv") / "arm.csv"
    write_csv(path, samples, joints)
    again = read_csv(path, joints)
    assert again.q.tobytes() == samples.q.tobytes()
    assert again.tau.tobytes() == samples.tau.tobytes()
    assert [p.name for p in path.parent.iterdir()] == ["arm.csv"]


@given(samples_of(), st.randoms(), st.booleans())
def test_columns_may_come_in_any_order_and_style(tmp_path_factory, drawn, chance, numbered):
    samples, joints = drawn
    n = len(joints)
    columns = {}
    for k, joint in enumerate(joints):
        for what, values in (("q", samples.q), ("tau", samples.tau)):
            name = f"{what}{k + 1}" if numbered else f"{joint}.{what}"
            columns[name.replace('"', '""')] = values[:, k]
    names = list(columns)
    chance.shuffle(names)
    lines = [",".join(f'"{name}"' for name in names)]
    for row in range(len(samples.q)):
        lines += ["", ", ".join(repr(float(columns[name][row])) for name in names), " , "]
    path = tmp_path_factory.mktemp("csv") / "arm.csv"
    path.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(lines).encode())  # as a spreadsheet does
    again = read_csv(path, joints)
    assert again.q.shape == (len(samples.q), n)
    assert again.q.tobytes() == samples.q.tobytes()
    assert again.tau.tobytes() == samples.tau.tobytes()


GOOD = "q1,q2,tau1,tau2"
REFUSED = {
    "empty": ("", "line 1: header is ''; accepted: q1,q2,tau1,tau2 or a.q,b.q,a.tau,b.tau"),
    "no samples": (GOOD + "\n\n", "number of samples is 0"),
    "missing column": ("q1,q2,tau1\n", "line 1: missing column is 'tau2'"),
    "unknown column": (GOOD + ",time\n", "line 1: unknown column is 'time'"),
    "repeated column": ("q1,q1,tau1,tau2\n", "line 1: repeated column is 'q1'"),
    "another robot's": ("q1,q2,q3,tau1,tau2,tau3\n", "line 1: unknown column is 'q3'"),
    "named for another robot": ("x.q,b.q,x.tau,b.tau\n", "line 1: unknown column is 'x.q'"),
    "no header": ("0,0,1,1\n", "line 1: header is '0,0,1,1'"),
    "semicolons": ("q1;q2;tau1;tau2\n0;0;1;1\n", "line 1: header is 'q1;q2;tau1;tau2'"),
    "short line": (GOOD + "\n0,0,1,1\n0,0,1\n", "line 3: number of columns is 3; accepted: 4"),
    "long line": (GOOD + "\n0,0,1,1,2\n", "line 2: number of columns is 5; accepted: 4"),
    "huge": (GOOD + "\n0,1e300,1,1\n", "column 'q2' is '1e300'; accepted: a finite number of at"),
    "tiny": ("q1,q2,tau1,tau2\n1,1,3e-308,-4e-310\n", "largest torque is 3e-308; accepted: torq"),
    "nan": (GOOD + "\n0,nan,1,1\n", "line 2: column 'q2' is 'nan'; accepted: a finite number"),
    "inf": (GOOD + "\n0,0,1,-inf\n", "line 2: column 'tau2' is '-inf'"),
    "too large": (GOOD + "\n0,0,1e999,1\n", "line 2: column 'tau1' is '1e999'"),
    "text": (GOOD + "\n0,0,1,1\n\n0,x,1,1\n", "line 4: column 'q2' is 'x'"),
    "nothing": (GOOD + "\n0,,1,1\n", "line 2: column 'q2' is ''"),
    "python's underscore": (GOOD + "\n0,1_0,1,1\n", "line 2: column 'q2' is '1_0'"),
    "other digits": (GOOD + "\n0,٣,1,1\n", "line 2: column 'q2' is '٣'"),
    "decimal commas": (GOOD + '\n"0,5",0,1,1\n', "line 2: column 'q1' is '0,5'"),
    "unclosed quote": (GOOD + '\n"0,0,1,1\n', "line 2: text is not CSV"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_files(tmp_path, case):
    text, message = REFUSED[case]
    path = tmp_path / "arm.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_csv(path, ["a", "b"])
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_no_text(tmp_path):
    with pytest.raises(InputError, match="file is not readable"):
        read_csv(tmp_path / "none.csv", ["a"])
    with pytest.raises(InputError, match="file is not readable"):
        read_csv(tmp_path, ["a"])
    path = tmp_path / "arm.csv"
    path.write_bytes(b"q1,tau1\n\xff\xfe,0\n")
    with pytest.raises(InputError, match="text is not UTF-8"):
        read_csv(path, ["a"])
    path.write_bytes(b"q1,tau1\n0\x00,0\n")
    with pytest.raises(InputError, match="line 2"):
        read_csv(path, ["a"])


def test_only_finite_samples_of_the_right_shape_are_written(tmp_path):
    path = tmp_path / "arm.csv"
    good = np.zeros((3, 2))
    for q, tau, message in (
        (good, np.zeros((3, 1)), "shape of tau"),
        (np.zeros((3, 3)), good, "shape of q"),
        (np.zeros(3), good, "shape of q"),
        (good, np.full((3, 2), np.nan), "tau is not finite"),
    ):
        with pytest.raises(InputError, match=message):
            write_csv(path, StaticSamples(q, tau), ["a", "b"])
    assert not path.exists()
    with pytest.raises(InputError, match="file is not writable"):
        write_csv(tmp_path / "none" / "arm.csv", StaticSamples(good, good), ["a", "b"])


@pytest.mark.parametrize(
    ("header", "names"),
    [
        ("q1,q2,tau1,tau2", ("q1", "q2")),
        ("tau2,q2,tau1,q1", ("q1", "q2")),
        ("elbow.q,base.q,base.tau,elbow.tau", ("elbow", "base")),
        (
            "q10,q2,q1,q3,q4,q5,q6,q7,q8,q9," + ",".join(f"tau{k}" for k in range(1, 11)),
            tuple(f"q{k}" for k in range(1, 11)),
        ),
    ],
)
def test_a_header_names_the_joints(tmp_path, header, names):
    path = tmp_path / "arm.csv"
    path.write_text(header + "\n")
    assert joint_names_of(path) == names


@pytest.mark.parametrize(
    "header",
    ["", "a,b", "q1,tau2", "q1,q3,tau1,tau3", "a.q", "a.q,a.q,a.tau", ".q,.tau", "q1,q1,tau1"],
)
def test_a_header_without_pairs_is_refused(tmp_path, header):
    path = tmp_path / "arm.csv"
    path.write_text(header + "\n")
    with pytest.raises(InputError, match=r"arm\.csv"):
        joint_names_of(path)
