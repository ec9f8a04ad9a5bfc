"""The run that README shows, command by command."""

import re
import shlex
from pathlib import Path

from isotorque.cli.main import status

ROOT = Path(__file__).parents[2]


def test_the_shown_run_prints_what_is_shown(tmp_path, capsys, monkeypatch):
    block = next(
        text
        for text in re.findall(r"```console\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
        if "table_arm.urdf" in text
    )
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    shown = []
    for line in block.splitlines():
        if line.startswith("$ isotorque "):
            shown.append((shlex.split(line)[2:], []))
        else:
            shown[-1][1].append(line)
    for words, lines in shown:
        status(words)
        streams = capsys.readouterr()
        printed = (streams.out + streams.err).replace("\r", "\n").splitlines()
        for line in lines:
            # the last digits of errors differ between machines
            exact = re.sub(r"RMSE .*", "", line)
            assert any(found.startswith(exact) for found in printed), line
