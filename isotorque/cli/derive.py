"""``isotorque derive``: the gravity torque of a robot, exactly."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from isotorque.cli.options import Json, NoSnap, RobotName
from isotorque.cli.output import emit_json, say
