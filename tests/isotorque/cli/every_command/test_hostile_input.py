"""Whatever files hold, a command answers, or says in one line why not: no traceback, no warning."""

import json
import os
import re
import warnings
from importlib.resources import files

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from isotorque.cli.main import status
from isotorque.learning.files.saved_models import SavedModel, save_model
from isotorque.learning.learners.registry import LearningTask, learner_by_name
from isotorque.symbolic.gravity.gravity_model import GravityModel
from isotorque.symbolic.robots.load_robot import load_robot

SLOW = os.environ.get("ISOTORQUE_SLOW") == "1"  # set by --slow too


def examples(count):
    """So many examples, with the slow tests ten times as many."""
    shared = [HealthCheck.function_scoped_fixture]  # which only looks at what was printed
    return settings(max_examples=10 * count if SLOW else count, suppress_health_check=shared)


ROBOTS = {
    name: files("isotorque.symbolic").joinpath(f"robot_files/{name}.urdf").read_text()
    for name in ("pendulum", "2r")
}
NUMBERS = [
    "0",
    "-0.0",
    "1",
    "-1",
    "1e-300",
    "-1e-320",
    "1e300",
    "-1e300",
    "1e16",
    "nan",
    "inf",
    "-inf",
    "",
    "x",
    "1_0",
    "1e-9",
    "3.14159",
    "0x10",
    "٣",
    "9" * 400,
]
WORDS = ["", " ", "a\nb", "\u202e", "\x00", "None", "2r", "[red]x[/red]", "%s", "é" * 300, "\ud800"]


@pytest.fixture
def answer(capfd):
    """Run a command; check what may not happen, whatever it was asked."""

    def run(*arguments):
        capfd.readouterr()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            code = status([str(a) for a in arguments])
        out, error = capfd.readouterr()
        assert code in (0, 1, 2), error
        for stream in (out, error):
            assert "Traceback" not in stream
            assert "Warning" not in stream
        if code == 2:
            *said, last = error.splitlines()
            assert last.startswith("error: ")
            assert all(line.startswith("warning: ") for line in said)
            assert all(line.isprintable() for line in (*said, last))
        else:
            assert "error: " not in error
        return code

    return run


def mutated(draw, text, tokens):
    """Replace some numbers of a text, or cut it."""
    places = [m.span() for m in re.finditer(r"-?\d+(\.\d+)?(e-?\d+)?", text)]
    chosen = draw(st.lists(st.sampled_from(places), min_size=1, max_size=4, unique=True))
    for start, end in sorted(chosen, reverse=True):
        text = text[:start] + draw(st.sampled_from(tokens)) + text[end:]
    if draw(st.integers(0, 9)) == 0:
        text = text[: draw(st.integers(0, len(text)))]
    return text


LEAVES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.sampled_from([2**63, -(10**30), 10**400]),
    st.sampled_from([0.0, 1e-320, 1e300, -1e300, 0.5]),
    st.sampled_from(WORDS[:-1]),
)
TREES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


def spots(document, path=()):
    """Every place of a JSON document."""
    yield path
    if isinstance(document, dict):
        for key in document:
            yield from spots(document[key], (*path, key))
    elif isinstance(document, list):
        for index in range(len(document)):
            yield from spots(document[index], (*path, index))


def disturbed(draw, document):
    """Put something else in some places of a JSON document."""
    document = json.loads(json.dumps(document))
    for _ in range(draw(st.integers(1, 2))):
        path = draw(st.sampled_from(sorted(spots(document), key=str)))
        if not path:
            return draw(TREES)
        place = document
        for key in path[:-1]:
            place = place[key]
        if isinstance(place, dict) and draw(st.integers(0, 4)) == 0:
            del place[path[-1]]
        else:
            place[path[-1]] = draw(TREES)
    return document


def text_of(document):
    return json.dumps(document).encode("utf-8", "surrogatepass")


@given(st.data())
@examples(6)
def test_robot_files(answer, tmp_path_factory, data):
    text = mutated(data.draw, ROBOTS[data.draw(st.sampled_from(sorted(ROBOTS)))], NUMBERS)
    file = tmp_path_factory.mktemp("robot") / "arm.urdf"
    file.write_text(text)
    more = data.draw(st.sampled_from([[], ["--tolerance", "1e-20"], ["--tolerance", "1e300"]]))
    answer("symmetries", file, *more)
    answer(data.draw(st.sampled_from(["derive", "domain"])), file)
    torque = data.draw(st.sampled_from(["0", "1e300", "-1e-320"]))
    answer("simulate", file, "--torque", ",".join([torque] * (1 + ("elbow" in text))))


@given(st.data())
@examples(5)
def test_recordings(answer, tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("data")
    rows = data.draw(st.integers(0, 12))
    column = st.sampled_from(["1.5", "-0.25", "0", "2", "0.1"])
    cells = [[data.draw(column) for _ in range(4)] for _ in range(rows)]
    for _ in range(data.draw(st.integers(0, 3)) if rows else 0):
        cells[data.draw(st.integers(0, rows - 1))][data.draw(st.integers(0, 3))] = data.draw(
            st.sampled_from(NUMBERS)
        )
    if rows and data.draw(st.booleans()):  # a column that says one thing throughout
        place, value = data.draw(st.integers(0, 3)), data.draw(st.sampled_from(NUMBERS[:10]))
        for row in cells:
            row[place] = value
    text = "q1,q2,tau1,tau2\n" + "".join(",".join(row) + "\n" for row in cells)
    (folder / "arm.csv").write_text(text)
    learner = data.draw(st.sampled_from(["recursive-least-squares", "parametric", "trigonometric"]))
    answer(
        "learn",
        "2r",
        "--data",
        folder / "arm.csv",
        "--out",
        folder / "out",
        "--quiet",
        "--learner",
        learner,
    )


CLAIM = {
    "joints": ["shoulder", "elbow"],
    "order": 1,
    "rank": 2,
    "basis": [[1, 0], [1, 1]],
    "relations": [
        {
            "A": [[-1, 0], [2, 1]],
            "d": [0.0, 0.0],
            "Y": [1, 1],
            "M": [[1, 0], [-1, -1]],
            "N": [[1, 0], [1, 1]],
            "rhs": [0.0, 0.0],
            "exact": True,
            "bound": [0.0, 0.0],
        }
    ],
}


@given(st.data())
@examples(6)
def test_relations(answer, tmp_path_factory, data):
    file = tmp_path_factory.mktemp("relations") / "relations.json"
    file.write_bytes(text_of(disturbed(data.draw, CLAIM)))
    answer("verify", file, "--robot", "2r")


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    folder = tmp_path_factory.mktemp("model")
    robot = load_robot("pendulum")
    q = [[0.1], [0.7], [-1.2], [2.0], [-2.5], [1.4]]
    learner = learner_by_name("trigonometric", None, LearningTask(1, 6, False, "pendulum"))
    learner.fit(q, GravityModel(robot).torque(q))
    save_model(SavedModel(learner, robot.name, robot.digest, robot.joint_names, {}), folder)
    return folder


@given(st.data())
@examples(6)
def test_models(answer, model, tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("disturbed")
    (folder / "model.npz").write_bytes((model / "model.npz").read_bytes())
    document = json.loads((model / "model.json").read_text())
    (folder / "model.json").write_bytes(text_of(disturbed(data.draw, document)))
    answer("verify", folder / "model.json", "--robot", "pendulum")
    answer("export", folder / "model.json", "--npz", folder / "arrays.npz")


TABLE = """robots = ["pendulum"]
learners = ["no-such-learner"]
seeds = 3
samples = 20
n_min = 2
angle_noise = [0.0, 0.1]
"""


@given(st.data())
@examples(6)
def test_sweep_tables(answer, tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("sweep")
    tokens = [*NUMBERS, '"x"', "[[1]]", "[]", "{}", "true", "1979-05-27", "10000000000", "2.0"]
    (folder / "t.toml").write_text(mutated(data.draw, TABLE, tokens))
    assert answer("sweep", folder / "t.toml", "--out", folder) == 2
    cells = ["pendulum", "no-such-learner", "1", "20"]
    for _ in range(2):
        cells[data.draw(st.integers(0, 3))] = data.draw(st.sampled_from([*NUMBERS, *WORDS[:-1]]))
    text = "robot,learner,seed,samples\n" + ",".join(cells) + "\n"
    (folder / "t.csv").write_text(text)
    assert answer("sweep", folder / "t.csv", "--out", folder) == 2


def planar_arm(n, length, mass, last, limits, effort, damping):
    """A planar arm of equal rods, the last one ``last`` times as heavy."""
    out, parent, (low, high) = ['<robot name="extreme"><link name="base"/>'], "base", limits
    for i in range(n):
        weight = mass * (last if i == n - 1 else 1.0)
        inertia = weight * length**2 / 12.0
        out.append(
            f'<joint name="j{i}" type="revolute"><parent link="{parent}"/><child link="l{i}"/>'
            f'<origin xyz="{length if i else 0} 0 0"/><axis xyz="0 -1 0"/>'
            f'<limit lower="{low}" upper="{high}" effort="{effort}" velocity="20"/>'
            f'<dynamics damping="{damping}"/></joint><link name="l{i}"><inertial>'
            f'<origin xyz="{length / 2.0} 0 0"/><mass value="{weight}"/><inertia '
            f'ixx="{inertia / 50.0}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/>'
            "</inertial></link>"
        )
        parent = f"l{i}"
    return "".join(out) + "</robot>"


ARMS = st.builds(
    planar_arm,
    n=st.integers(1, 2),
    length=st.sampled_from([0.25, 1e-4, 1e4, 1e-150, 1e100]),
    mass=st.sampled_from([5.0, 1e-6, 1e6, 1e-200, 1e200]),
    last=st.sampled_from([1.0, 1e-9, 1e6]),
    limits=st.sampled_from([(-3.14159, 3.14159), (-1.58, -1.56), (-1e-9, 1e-9), (0.3, 3.0)]),
    effort=st.sampled_from([100.0, 1e-3, 1e-300, 0.0, -1.0]),
    damping=st.sampled_from([0.0, 1e-9, 1e6]),
)


@given(ARMS)
@examples(3)
def test_extreme_arms(answer, tmp_path_factory, text):
    folder = tmp_path_factory.mktemp("arm")
    file, few = folder / "arm.urdf", ["--samples", "8", "--quiet", "--learner"]
    file.write_text(text)
    if answer("discover", file, "--out", folder / "d") == 0:
        answer("relations", folder / "d", "--candidates", "exact")
    answer("learn", file, "--strategy", "lattice", "--out", folder / "l", *few, "trigonometric")
    if SLOW:
        answer("run", file, "--out", folder / "r", *few, "recursive-least-squares")


HUGE = ["1e300", "-1", "nan", "1e-320", "9" * 30, "x"]


@pytest.mark.parametrize("value", HUGE)
@pytest.mark.parametrize(
    "arguments",
    [
        ["symmetries", "2r", "--tolerance"],
        ["simulate", "pendulum", "--torque"],
        ["simulate", "pendulum", "--torque", "1", "--from"],
        ["simulate", "pendulum", "--torque", "1", "--angle-noise"],
        ["simulate", "pendulum", "--torque", "1", "--torque-noise"],
        ["simulate", "pendulum", "--torque", "1", "--encoder-step"],
        ["simulate", "pendulum", "--torque", "1", "--seed"],
        ["domain", "2r", "--center"],
    ],
)
def test_options(answer, arguments, value):
    if arguments[-1] == "--center":
        value = f"{value},0"
    answer(*arguments[:-1], f"{arguments[-1]}={value}")
