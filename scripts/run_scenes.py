#!/usr/bin/env python3
"""Runs every scene of scenes/ headless and checks what it leaves behind: it completes, every number is finite, the mass
of each body is density times volume, and the energy ledger balances. Each runs for a moment; as written with --long."""

import argparse
import pathlib
import subprocess
import tempfile
import time
import tomllib

import summary
from report import Report, side_by_side

ROOT = pathlib.Path(__file__).resolve().parent.parent
PHYXEL = ROOT / "build" / "release" / "bin" / "phyxel"
SHORT = 0.1  # [s] simulated, long enough for the demo's writers to write whole frames
BALANCE_BOUND = 0.02  # of the largest total of the energy ledger


def densities(scene):
    """Density [kg/m^3] of each body of one material given by number. Presets are left to the tests of the library."""
    materials = {material["name"]: material.get("density") for material in scene["material"]}
    single = [body for body in scene["body"] if not body.get("region") and materials.get(body["material"])]
    return {body["name"]: materials[body["material"]] for body in single}


def run(path, folder, long):
    """Runs one scene into `folder`. Returns (what is wrong or nothing, steps a second)."""
    scene = tomllib.loads(path.read_text())
    options = []
    if not long:
        duration = min(SHORT, scene.get("simulation", {}).get("duration", 2.0))
        options = ["--set", f"simulation.duration={duration}"]
    result = subprocess.run([PHYXEL, "run", path, "-o", folder, *options], capture_output=True, text=True)
    if result.returncode != 0:
        return f"exit code {result.returncode}: {result.stderr.strip()[-1500:]}", 0
    found = summary.load(folder / "summary.json")
    if not (folder / "probes.csv").exists():
        return "no probes.csv", 0
    return summary.problem(found, densities(scene), BALANCE_BOUND), found["steps_per_second"]


def checked_run(path, long):
    """The same, and the time it took [s]."""
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        try:
            problem, rate = run(path, pathlib.Path(folder), long)
        except (OSError, ValueError, KeyError) as error:
            problem, rate = f"{type(error).__name__}: {error}", 0
    return problem, rate, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="each for its whole duration")
    options = parser.parse_args()
    report = Report()
    scenes = sorted((ROOT / "scenes").glob("*.toml"))
    results = side_by_side(lambda path: checked_run(path, options.long), scenes)
    for path, (problem, rate, seconds) in zip(scenes, results):
        if report.check(f"scene {path.stem}", problem):
            print(f"{path.stem}: {seconds:.1f} s, {rate:.0f} steps a second")
    report.finish()


if __name__ == "__main__":
    main()
