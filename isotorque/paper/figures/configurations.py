"""Figures 1, 2, 5, 6, 9 and 10 to 12, 14, 15 of the paper from our data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from isotorque.paper.figures.maintained import maintained_map
from isotorque.paper.figures.many_to_one import many_to_one
from isotorque.verify.report.figures.arm_structure import arm_structure
from isotorque.verify.report.figures.configurations import domain_map, explored_map
from isotorque.verify.report.figures.joint_angles import joint_angles
from isotorque.verify.report.figures.level_sets import level_set_map, stick_figure
from isotorque.verify.report.run_figures import Picture

Data = Mapping[str, Any]
_STAY = (
    "Crosses: targets; circles: where the learned torque is in equilibrium, filled where the arm "
    "stays there without controller."
)


def symmetry_pictures(data: Data) -> Iterator[Picture]:
    """Draw Fig. 1, 2 and 5 from the experiment ``symmetries-2r``."""
    q, sets = np.array(data["q"]), np.array(data["sets"])
    stable = np.array(data["stable"], dtype=bool)
    torque = ", ".join(f"{x:.3g}" for x in data["torque"])
    yield Picture(
        "fig1",
        "2r",
        f"Many to one: {len(q)} configurations need the torque ±({torque}) N m, signs apart.",
        many_to_one(q, np.array(data["torques"])),
        wide=True,
    )
    yield Picture(
        "fig2a",
        "2r",
        "Symmetric configurations in primary sets. Solid: stable, dashed: unstable.",
        stick_figure(np.array(data["links"]), sets, stable=stable),
        wide=True,
    )
    curves = [(int(c["joint"]), int(c["sign"]), np.array(c["points"])) for c in data["curves"]]
    labels = [str(1 + int(np.sum(sets[:i] == sets[i]))) for i in range(len(sets))]
    yield Picture(
        "fig2b",
        "2r",
        "Component-wise level sets (Eq. 6 and 7) and their intersections. Filled: "
        "stable, hollow: unstable.",
        level_set_map(curves, q, sets, labels=labels, stable=stable),
    )
    yield Picture(
        "fig5",
        "2r",
        "Physical joint angles q1, q2 and the virtual angle q*.",
        joint_angles(np.array(data["posture"])[0]),
    )


def domain_picture(data: Data) -> Iterator[Picture]:
    """Draw Fig. 6 from the experiment ``domain-2r``."""
    yield Picture(
        "fig6",
        "2r",
        f"The BCTS and its {len(data['images'])} images under the group.",
        domain_map(
            np.array(data["polygon"]),
            images=np.array(data["images"]),
            center=np.array(data["center"]),
        ),
    )


def structure_picture(data: Data) -> Iterator[Picture]:
    """Draw Fig. 9 from the experiment ``ranges-3r``."""
    skeleton = data["skeleton"]
    yield Picture(
        "fig9",
        "3r",
        "Structure of the 3R arm: axis 1 horizontal, along the arm stretched out at "
        "q = 0; axes 2 and 3 parallel, perpendicular to it.",
        arm_structure(
            skeleton["joints"], skeleton["axes"], skeleton["centres"][-1], skeleton["masses"][-1]
        ),
    )


def online_pictures(literal: Data, iterated: Data) -> Iterator[Picture]:
    """Draw Fig. 10 to 12 from the experiments ``literal-2r`` and ``iterated-2r``."""
    polygon = None if literal["polygon"] is None else np.array(literal["polygon"])
    yield Picture(
        "fig10",
        "2r",
        "Explored configurations, and those learned from them by symmetry: the BCTS "
        "explored is the one in which the arm holds itself.",
        explored_map(np.array(literal["explored"]), np.array(literal["images"]), domain=polygon),
    )
    for name, key, data, words in (
        ("fig11", "maintained_66", literal, "66 targets in the paper's BCTS, LLM"),
        ("fig12a", "maintained_90", literal, "90 targets, LLM"),
        ("fig12b", "maintained_84", iterated, "84 targets, LLM_it after twice 30 iterations"),
    ):
        yield _maintained(name, "2r", words, data[key])


def arm_pictures(
    online: Data | None, batch_2r: Data | None, batch_3r: Data | None
) -> Iterator[Picture]:
    """Draw Fig. 14 and 15 from the experiments on the 3R arm and on batch learning."""
    if batch_2r is not None:
        yield _maintained(
            "fig14a",
            "batch",
            "90 targets of the 2R arm, 255 samples, 18 neurons",
            batch_2r["maintained_90"],
        )
    if batch_3r is not None:
        yield _maintained(
            "fig14b",
            "batch",
            "64 targets of the 3R arm, 600 samples, 30 neurons",
            batch_3r["maintained_fine"],
        )
    if online is not None:
        yield _maintained(
            "fig15a",
            "3r",
            "64 targets of the 3R arm, LLM_it, guided arm while learning",
            online["maintained_64"],
        )
    if batch_3r is not None:
        yield _maintained(
            "fig15b",
            "batch",
            "64 targets of the 3R arm, 65 samples, 18 neurons",
            batch_3r["maintained_small"],
        )


def _maintained(name: str, section: str, words: str, data: Data) -> Picture:
    arrays = (np.array(data["targets"]), np.array(data["observed"]), np.array(data["held"]))
    wide = arrays[0].shape[1] > 2
    return Picture(name, section, f"{words}. {_STAY}", maintained_map(*arrays), wide=wide)
