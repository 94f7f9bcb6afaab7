"""Reads and judges the summary.json that a run leaves behind (docs/stages/output.md says what it holds)."""

import json
import math

MASS_TOLERANCE = 1e-9  # mass = density x mesh volume, relative


def load(path):
    """The summary at `path`; numbers that JSON does not know (NaN, Infinity) raise ValueError."""

    def refuse(name):
        raise ValueError(f"{path.name} holds {name}")

    return json.loads(path.read_text(), parse_constant=refuse)


def not_finite(value, name="summary"):
    """The name of the first number that is not finite, or an empty string."""
    if isinstance(value, float):
        return "" if math.isfinite(value) else name
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return next(filter(None, (not_finite(item, f"{name}.{key}") for key, item in items)), "")


def problem(summary, densities, balance_bound):
    """Why a completed run is not as it should be, or an empty string. `densities` [kg/m^3] by body; bodies of several
    materials are left out of it. `balance_bound` limits energy.balance_error."""
    if summary["status"] != "completed":
        return f"status is {summary['status']}: {summary['message']}"
    if name := not_finite(summary):
        return f"{name} is not finite"
    for name, density in densities.items():
        body = summary["bodies"][name]
        expected = density * body["mesh_volume"]
        if abs(body["mass"] - expected) > MASS_TOLERANCE * expected:
            return f"mass of {name} is {body['mass']!r}, density times volume {expected!r}"
    if abs(summary["energy"]["balance_error"]) > balance_bound:
        return f"energy.balance_error is {summary['energy']['balance_error']}, bound {balance_bound}"
    return ""
