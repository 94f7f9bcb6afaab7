#!/usr/bin/env python3
"""Checks the text of every tracked file: no absolute path of somebody's machine, no private address, no unfinished
mark, no trailing blank, a newline at the end."""

import pathlib
import re
import subprocess

from report import Report

ROOT = pathlib.Path(__file__).resolve().parent.parent
BINARY = {".png", ".jpg", ".mp4", ".glb", ".ply", ".stl", ".npz"}
GENERATED = {".obj"}

FORBIDDEN = {
    "an absolute path of a machine": r"(?<![\w.$}])/(?:work|home|root|Users|mnt|media|tmp/[a-z]+\.)/?[\w./-]*/[\w.-]+",
    "a private host or address": r"\b(?:10|192\.168|172\.(?:1[6-9]|2\d|3[01]))(?:\.\d{1,3}){2,3}\b|\b[\w-]+\.(?:internal|lan|corp)\b",
    "an unfinished mark": r"\b(?:TO" r"DO|FIX" r"ME|XX" r"X)\b",
}


def tracked():
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in names.split("\0") if name and (ROOT / name).exists()]


def main():
    report, found = Report(), {kind: [] for kind in [*FORBIDDEN, "a blank at a line's end", "a last line without its end"]}
    for path in tracked():
        if path.suffix in BINARY or path.is_symlink():
            continue
        name, text = path.relative_to(ROOT), path.read_text(errors="replace")
        if text and not text.endswith("\n"):
            found["a last line without its end"].append(str(name))
        if path.suffix in GENERATED:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            if line != line.rstrip():
                found["a blank at a line's end"].append(f"{name}:{number}")
            for kind, pattern in FORBIDDEN.items():
                if re.search(pattern, line) and path != pathlib.Path(__file__).resolve():
                    found[kind].append(f"{name}:{number}")
    for kind, places in found.items():
        report.check(f"no file has {kind}", ", ".join(places[:20]))
    report.finish()


if __name__ == "__main__":
    main()
