#!/usr/bin/env python3
"""Draws the picture of a study: python3 plot.py NAME FOLDER reads FOLDER/NAME.csv and writes FOLDER/NAME.png."""

import csv
import pathlib
import sys

try:
    import matplotlib
except ImportError:
    sys.exit(3)

matplotlib.use("Agg")
import matplotlib.collections
import matplotlib.pyplot as plt
import numpy as np


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def read(path):
    with open(path, newline="") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def groups(rows, key):
    """The rows by their value of a column, in the order of the table."""
    return {value: [row for row in rows if row[key] == value] for value in dict.fromkeys(row[key] for row in rows)}


def column(rows, key):
    return [row[key] for row in rows]


def lines(axes, rows, group, x, y, absolute=False):
    for name, part in groups(rows, group).items():
        values = [abs(value) for value in column(part, y)] if absolute else column(part, y)
        axes.plot(column(part, x), values, "o-", markersize=3, linewidth=1, label=name)
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def accuracy(figure, rows, _):
    for axes, (load, part) in zip(figure.subplots(1, 2), groups(rows, "load").items()):
        lines(axes, part, "method", "nodes", "error [%]", absolute=True)
        axes.set_title(load)
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.legend(fontsize=7)


def convergence(figure, rows, _):
    for axes, (load, part) in zip(figure.subplots(1, 2), groups(rows, "load").items()):
        lines(axes, part, "quadrature", "nodes", "difference")
        nodes = column(part, "nodes")
        start = part[0]["difference"]
        axes.plot(nodes, [start * nodes[0] / n for n in nodes], "k:", linewidth=1, label="spacing cubed")
        axes.set_title(load)
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.legend(fontsize=7)


def locking(figure, rows, _):
    left, right = figure.subplots(1, 2)
    for name, part in groups(rows, "method").items():
        x = [0.5 - nu for nu in column(part, "nu")]
        left.plot(x, column(part, "error [%]"), "o-", markersize=3, linewidth=1, label=name)
        right.plot(x, column(part, "tip x [mm]"), "o-", markersize=3, linewidth=1, label=name)
    for axes, label in ((left, "error of the tip [%]"), (right, "sideways drift of the tip [mm]")):
        axes.set_xscale("log")
        axes.invert_xaxis()
        axes.set_xlabel("1/2 - nu")
        axes.set_ylabel(label)
    right.legend(fontsize=6)


def ghost_forces(figure, rows, _):
    left, right = figure.subplots(1, 2)
    lines(left, [row for row in rows if row["force [N]"] > 0], "law", "force [N]", "volume")
    lines(right, [row for row in rows if row["turn [deg]"] > 0], "law", "turn [deg]", "energy [J]")
    left.set_title("bent")
    right.set_title("turned as a whole")
    left.legend(fontsize=7)


def rotation(figure, rows, _):
    left, right = figure.subplots(1, 2)
    lines(left, rows, "rotation", "stretch", "turned [deg]")
    lines(right, rows, "rotation", "stretch", "work of a loop")
    right.set_yscale("log")
    left.legend(fontsize=7)


def timing(figure, rows, _):
    for axes, (load, part) in zip(figure.subplots(1, 2), groups(rows, "load").items()):
        lines(axes, part, "method", "nodes", "time [s]")
        axes.set_title(load)
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.legend(fontsize=7)


def two_materials(figure, rows, _):
    axes = figure.subplots()
    lines(axes, rows, "cylinder", "x [m]", "height [m]")
    axes.legend(fontsize=7)


def irregular_steps(figure, _, folder):
    paths = groups(read(folder / "irregular-steps-paths.csv"), "run")
    for axes, scheme in zip(figure.subplots(1, 2, sharey=True), ("implicit Euler", "BDF2")):
        for name, part in paths.items():
            if name.startswith(scheme):
                axes.plot(column(part, "time [s]"), column(part, "height [m]"), "o-", markersize=2, linewidth=1,
                          label=name.split(", ")[1])
        axes.set_title(scheme)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("height of the tip [m]")
    axes.legend(fontsize=7)


def nodal_integration(figure, rows, _):
    left, right = figure.subplots(1, 2)
    bent = [row for row in rows if row["load"] == "bending"]
    lines(left, bent, "volumes", "nodes", "error [%]")
    lines(right, bent, "volumes", "nodes", "volume")
    for axes in (left, right):
        axes.set_xscale("log")
    left.legend(fontsize=7)


def support(figure, rows, _):
    for axes, (load, part) in zip(figure.subplots(1, 2), groups(rows, "load").items()):
        lines(axes, part, "nodes", "support", "error [%]")
        axes.axhline(0, color="k", linewidth=0.5)
        axes.set_title(load)
    axes.legend([f"{count:.0f} nodes" for count in groups(rows, "nodes")], fontsize=7)


def seen(X, yaw=0.6, pitch=0.3):
    """To the right, up and towards the eye, of an eye that looks down a little from in front."""
    x, y, z = X.T
    right, front = np.cos(yaw) * x - np.sin(yaw) * z, np.sin(yaw) * x + np.cos(yaw) * z
    return np.stack([right, np.cos(pitch) * y - np.sin(pitch) * front, np.sin(pitch) * y + np.cos(pitch) * front], 1)


def draw_bodies(axes, bodies, floor_width):
    """Shaded triangles, [(corners (n, 3, 3), colour)], the farthest first, on a square floor at y = 0."""
    floor = floor_width / 2 * np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    axes.fill(*seen(floor)[:, :2].T, color="0.92")
    shown, colours, depths = [], [], []
    for faces, colour in bodies:
        faces = seen(faces.reshape(-1, 3)).reshape(-1, 3, 3)
        normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        front = normal[:, 2] > 0
        light = 0.35 + 0.65 * np.clip(normal[front] @ np.array([-0.4, 0.7, 0.6]), 0, 1)
        shown.append(faces[front, :, :2])
        depths.append(faces[front, :, 2].mean(axis=1))
        colours.append(np.array(matplotlib.colors.to_rgb(colour)) * light[:, None])
    order = np.argsort(np.concatenate(depths))
    colours = np.concatenate(colours)[order]
    axes.add_collection(matplotlib.collections.PolyCollection(
        np.concatenate(shown)[order], facecolors=colours, edgecolors=colours, linewidths=0.2))
    axes.set(aspect="equal", xticks=[], yticks=[])
    axes.set_frame_on(False)


def points(rows):
    return np.array([[row[axis] for axis in "xyz"] for row in rows])


def corners(rows):
    return np.array([[row[corner] for corner in "abc"] for row in rows], int)


def torus_on_floor(figure, rows, folder):
    names = ["time", "nodes before", "surface before", "nodes after", "surface after"]
    panels = dict(zip(names, figure.subplots(1, 5, width_ratios=[1.2, 1, 1, 1, 1])))
    panels["time"].plot(column(rows, "time [s]"), column(rows, "lowest [m]"), label="lowest point")
    panels["time"].plot(column(rows, "time [s]"), column(rows, "center [m]"), label="center of mass")
    panels["time"].set_xlabel("time [s]")
    panels["time"].set_ylabel("height [m]")
    panels["time"].legend(fontsize=7)
    triangles = corners(read(folder / "torus-on-floor-triangles.csv"))
    for when, part in groups(read(folder / "torus-on-floor-shapes.csv"), "when").items():
        kinds = groups(part, "what")
        for what in ("nodes", "surface"):
            axes = panels[f"{what} {when}"]
            draw_bodies(axes, [(points(kinds["surface"])[triangles], "C1" if what == "surface" else "0.95")], 0.3)
            axes.set(xlim=(-0.21, 0.21), ylim=(-0.08, 0.38))
            axes.set_title(f"{what} {when}", fontsize=9)
        panels[f"nodes {when}"].plot(*seen(points(kinds["node"]))[:, :2].T, "r.", markersize=1)


def pile(figure, rows, folder):
    times = groups(read(folder / "pile-shapes.csv"), "time")
    triangles = {body: corners(part) for body, part in groups(read(folder / "pile-triangles.csv"), "body").items()}
    highest = max(column(next(iter(times.values())), "y")) + 0.05
    panels = figure.subplots(1, len(times) + 1, width_ratios=[1] * len(times) + [1.2])
    for axes, (time, part) in zip(panels, times.items()):
        bodies = [(points(vertices)[triangles[body]], f"C{int(body)}")
                  for body, vertices in groups(part, "body").items()]
        draw_bodies(axes, bodies, 0.3)
        axes.set(xlim=(-0.23, 0.23), ylim=(-0.1, highest))
        axes.set_title(f"{time:.2g} s", fontsize=9)
    panels[-1].plot(column(rows, "time [s]"), column(rows, "kinetic [J]"))
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_ylabel("kinetic energy [J]")
    panels[-1].set_yscale("log")


STUDIES = {
    "accuracy": accuracy,
    "convergence": convergence,
    "locking": locking,
    "ghost-forces": ghost_forces,
    "rotation": rotation,
    "timing": timing,
    "two-materials": two_materials,
    "irregular-steps": irregular_steps,
    "nodal-integration": nodal_integration,
    "support": support,
    "torus-on-floor": torus_on_floor,
    "pile": pile,
}


def main(name, folder):
    folder = pathlib.Path(folder)
    figure = plt.figure(figsize=(8, 3.6), layout="constrained")
    STUDIES[name](figure, read(folder / f"{name}.csv"), folder)
    figure.savefig(folder / f"{name}.png", dpi=90)


if __name__ == "__main__":
    main(*sys.argv[1:])
