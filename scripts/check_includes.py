#!/usr/bin/env python3
"""Checks the direction of includes: a folder of src/ includes only itself and the folders above it in the order of
PHYXEL_FOLDERS in CMakeLists.txt, a public header only from the folder on where its subject lives."""

import pathlib
import re

from report import Report

ROOT = pathlib.Path(__file__).resolve().parent.parent

# The folder in which the subject of a public header lives: only it and those below may include the header. body.h and
# material.h are plain settings without code, colliders among them, which the renderer and the sampling already read;
# world.h declares what they report, StepReport and Surface among them.
PUBLIC = {
    "vector": "base",
    "error": "base",
    "version": "base",
    "mesh": "geometry",
    "material": "geometry",
    "body": "geometry",
    "solver": "model",
    "world": "surface",
    "phyxel": "world",
}


def folder_order():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"set\(PHYXEL_FOLDERS ([^)]*)\)", text).group(1).split()


def problems(path, folder, order):
    """What `path`, which lives in `folder`, includes against the direction."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s+["<]([^">]+)/([^">]+)[">]', line)
        if not match:
            continue
        target, header = match.groups()
        if target == "phyxel":
            target = PUBLIC.get(header.removesuffix(".h"))
            if target is None:
                yield f"line {number} includes phyxel/{header}, which PUBLIC in scripts/check_includes.py does not name"
                continue
        elif target not in order:
            continue  # a library's header
        if order.index(target) > order.index(folder):
            yield f"line {number} includes {match.group(1)}/{header}, but {folder}/ stands above {target}/"


def main():
    report, order = Report(), folder_order()
    for folder in sorted(p.name for p in (ROOT / "src").iterdir() if p.is_dir()):
        if folder not in order:
            report.check(f"includes src/{folder}", "not listed in PHYXEL_FOLDERS of CMakeLists.txt")
    for folder in order:
        found = [
            f"{path.relative_to(ROOT)} {problem}"
            for path in sorted((ROOT / "src" / folder).rglob("*.[hc]*"))
            for problem in problems(path, folder, order)
        ]
        report.check(f"includes src/{folder}", "; ".join(found))
    internal = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / "include").rglob("*.h"))
        if re.search(rf'#\s*include\s+["<]({"|".join(order)})/', path.read_text())
    ]
    report.check("includes include/phyxel", "; ".join(f"{path} includes an internal header" for path in internal))
    report.finish()


if __name__ == "__main__":
    main()
