"""``isotorque run``: the whole scheme, from the robot file to the report."""


def run() -> None:
    """Run the whole scheme."""
