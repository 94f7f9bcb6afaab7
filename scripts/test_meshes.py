#!/usr/bin/env python3
"""Drops scanned and broken meshes of Debian's libcgal-demo for one second each. A closed one completes with mass =
density x volume and no NaN; a broken one does so too, or is refused with exit code 2 and the reason and the place."""

import argparse
import pathlib
import random
import re
import subprocess
import tarfile
import tempfile
import time

import summary
from report import Report, side_by_side

ROOT = pathlib.Path(__file__).resolve().parent.parent
PHYXEL = ROOT / "build" / "release" / "bin" / "phyxel"
ARCHIVE = pathlib.Path("/usr/share/doc/libcgal-demo/data.tar.gz")

CLOSED = ("bunny00", "armadillo", "elephant", "camel", "hand", "fandisk", "knot")
BROKEN = ("cow", "pig", "lion-head", "mannequin-devil", "nefertiti", "mushroom", "mech-holes-shark")

SIZE = 0.2  # [m] height of a body
DENSITY = 1000.0  # [kg/m^3]
BALANCE_BOUND = 0.05  # of the largest total of the energy ledger
NODES = 600
SEED = 20

SCENE = """
[simulation]
duration = 1.0

[[material]]
name = "jelly"
density = {density}
youngs_modulus = 1.0e4
poissons_ratio = 0.4

[[body]]
name = "body"
mesh = "{mesh}"
material = "jelly"
scale = {scale!r}
translation = [0.0, {lift!r}, 0.0]
sampling = {{ nodes = "cubic", count = {nodes} }}

[[collider]]
plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}

[output]
formats = []
"""


def unpack(names, folder):
    """Path by name of the meshes taken out of the archive."""
    paths = {}
    with tarfile.open(ARCHIVE) as archive:
        for member in archive:
            path = pathlib.PurePath(member.name)
            if path.suffix == ".off" and path.stem in names:
                paths[path.stem] = folder / path.name
                paths[path.stem].write_bytes(archive.extractfile(member).read())
    return paths


def heights(path):
    """Lowest and highest y of an OFF mesh."""
    numbers = re.sub(r"#.*", "", path.read_text(errors="replace")).split()
    first = 1 if numbers[0].upper().endswith("OFF") else 0
    count = int(numbers[first])
    ys = [float(y) for y in numbers[first + 4 : first + 3 + 3 * count : 3]]
    return min(ys), max(ys)


def write_scene(mesh, folder):
    low, high = heights(mesh)
    scale = SIZE / (high - low)
    path = folder / f"{mesh.stem}.toml"
    path.write_text(SCENE.format(density=DENSITY, mesh=mesh.name, scale=scale, lift=0.05 - low * scale, nodes=NODES))
    return path


def names_reason_and_place(message, mesh):
    """A refusal names the mesh, says why in words, and gives a place: three coordinates, or a line, or an element."""
    place = re.search(r"\(\s*-?[\d.e+-]+,\s*-?[\d.e+-]+,\s*-?[\d.e+-]+\s*\)|\bline \d+|\b(?:triangle|vertex|edge) \d+", message)
    return mesh.name in message and len(message.split()) >= 8 and bool(place)


def drop(name, mesh, folder):
    """Simulates one mesh. Returns (what happened, what is wrong or nothing)."""
    output = folder / name
    result = subprocess.run([PHYXEL, "run", write_scene(mesh, folder), "-o", output], capture_output=True, text=True)
    if result.returncode == 2 and name in BROKEN:
        message = result.stderr.strip()
        return "refused: " + message, "" if names_reason_and_place(message, mesh) else f"unclear refusal: {message}"
    if result.returncode != 0:
        return "ended badly", f"exit code {result.returncode}: {result.stderr.strip()[-1500:]}"
    found = summary.load(output / "summary.json")
    body = found["bodies"]["body"]
    done = f"completed, {body['nodes']} nodes, {body['mass']:.4f} kg, {found['steps_per_second']:.0f} steps a second"
    return done, summary.problem(found, {"body": DENSITY}, BALANCE_BOUND)


def checked_drop(name, mesh, folder):
    """The same, and the time it took [s]."""
    begin = time.monotonic()
    try:
        done, problem = drop(name, mesh, folder)
    except (OSError, ValueError, KeyError) as error:
        done, problem = "no result", f"{type(error).__name__}: {error}"
    return done, problem, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=int, metavar="N", help="only N of them, always the same")
    parser.add_argument("--mesh", action="append", choices=[*CLOSED, *BROKEN], help="only this one; may be repeated")
    options = parser.parse_args()

    names = options.mesh or [*CLOSED, *BROKEN]
    if options.sample:
        names = random.Random(SEED).sample(names, options.sample)
    report = Report()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        meshes = sorted(unpack(names, folder).items())
        results = side_by_side(lambda item: checked_drop(*item, folder), meshes)
        for (mesh, _), (done, problem, seconds) in zip(meshes, results):
            if report.check(f"mesh {mesh}", problem):
                print(f"{mesh:18} {'closed' if mesh in CLOSED else 'broken'}  {seconds:5.1f} s  {done}")
    report.finish()


if __name__ == "__main__":
    main()
