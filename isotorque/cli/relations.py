"""``isotorque relations``: symmetry relations learned from a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Json, Quiet
from isotorque.cli.output import emit_json, say


def relations(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a discovery.", show_default=False)
    ],
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Learn (M, N, d) from the settled samples of RUN alone; also written to RUN/relations.json."""
    import json as text

    from isotorque.cli.files import write_whole
    from isotorque.cli.output import plain
    from isotorque.experiment import DATABASE
    from learning.recordings.recording_reader import RecordingReader
    from learning.relations.relation_learning import learn_relations
    from verify.relation_files import relations_document

    with RecordingReader(run / DATABASE) as reader:
        samples = reader.samples(phase="discovery")
        joints = reader.joint_names
    learned = learn_relations(samples.q, samples.tau)
    extra = [
        {
            "known": str(entry.known),
            "standard_error": plain(entry.standard_error),
            "support": entry.support,
            "p_value": plain(entry.p_value),
        }
        for entry in learned.relations
    ]
    document = relations_document(learned.group, joints, extra=extra) | {
        "method": learned.method,
        "missing": learned.missing,
        "samples": len(samples.q),
    }
    write_whole(run / "relations.json", text.dumps(plain(document), indent=1) + "\n")
    if json:
        emit_json(document)
        return
    print(f"{learned.order} relations from {len(samples.q)} settled samples, by {learned.method}")
    for entry in learned.relations:
        print(f"  {entry.relation}  [{entry.known}, {entry.support} torques]")
    if learned.missing:
        print(f"missing: {learned.missing}")
    say(f"written: {run / 'relations.json'}", quiet)
