"""A run in a process of its own, to be killed: records ToyArm, then writes what it saw.

Tells on standard output how far it has come.

    python -m tests.learning.recordings.recording_child RUN.sqlite RESULT STEPS
"""

import hashlib
import itertools
import sys
from pathlib import Path

from isotorque.learning.files.run_info import RunInfo
from isotorque.learning.recordings.recorded_arm import RecordedArm
from isotorque.learning.recordings.recording import Recording
from tests.learning.recordings.recording_tools import NAMES, ToyArm, explore


def main(path: Path, result: Path, steps: int) -> None:
    info = RunInfo("toy", "0123abcd", NAMES, seed=7, options={"steps": steps})
    commands = itertools.islice(itertools.cycle(["apply", "apply", "play", "home"]), steps)
    seen = hashlib.sha256()
    with Recording.open_or_create(path, info) as recording:
        arm = RecordedArm(ToyArm(), recording)
        for number, step in enumerate(explore(arm, commands, seed=7)):
            seen.update(step)
            if number % 25 == 0:
                print(number, flush=True)
            if number % 50 == 0:
                arm.save_checkpoint("digest", {"digest": seen.hexdigest()})
        arm.finish()
    result.write_text(seen.hexdigest())


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
