#!/usr/bin/env python3
"""Checks the code samples of the documentation. A block that begins with ```cpp compile is compiled as a program,
one with ```toml scene is simulated for a moment, any other ```toml block is parsed."""

import pathlib
import re
import subprocess
import tempfile
import tomllib

from report import Report, side_by_side

ROOT = pathlib.Path(__file__).resolve().parent.parent
PHYXEL = ROOT / "build" / "release" / "bin" / "phyxel"


def samples():
    """(name, kind, text) of each block of code."""
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        if not page.exists():
            continue
        text = page.read_text()
        for match in re.finditer(r"^```(.+?)\n(.*?)^```", text, re.M | re.S):
            line = text.count("\n", 0, match.start()) + 1
            yield f"{page.relative_to(ROOT)}:{line}", match.group(1).strip(), match.group(2)


def as_program(text):
    """The sample as a program: as it stands when it has a main, else its statements in one."""
    if "int main(" in text:
        return text
    lines = text.splitlines()
    includes = [line for line in lines if line.startswith("#include")]
    return "\n".join([*includes, "int main() {", *(line for line in lines if line not in includes), "}", ""])


def compile_problem(text):
    result = subprocess.run(
        ["g++", "-std=c++20", "-Wall", "-Wno-unused", "-Werror", "-fsyntax-only", "-I", ROOT / "include", "-x", "c++", "-"],
        input=as_program(text), capture_output=True, text=True,
    )
    return result.stderr.strip()[:2000]


def scene_problem(text, folder):
    # Meshes are named relative to the scene file, so it stands where the scenes stand.
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=ROOT / "scenes", delete=False) as scene:
        scene.write(text)
    try:
        result = subprocess.run(
            [PHYXEL, "run", scene.name, "-o", folder, "--set", "simulation.duration=0.02"], capture_output=True, text=True
        )
    finally:
        pathlib.Path(scene.name).unlink()
    return "" if result.returncode == 0 else f"exit code {result.returncode}: {result.stderr.strip()[:2000]}"


def parse_problem(text):
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        return str(error)
    return ""


def problem_of(sample):
    """Why a sample does not hold, or nothing; None for one that needs no check."""
    _, kind, text = sample
    if kind == "cpp compile":
        return compile_problem(text)
    if not kind.startswith("toml"):
        return None
    problem = parse_problem(text)
    if problem or kind != "toml scene" or not PHYXEL.exists():
        return problem
    with tempfile.TemporaryDirectory() as folder:
        return scene_problem(text, folder)


def main():
    report, found = Report(), list(samples())
    for (name, kind, _), problem in zip(found, side_by_side(problem_of, found)):
        if problem is not None:
            report.check(f"sample {name}", problem)
        if kind == "toml scene" and not PHYXEL.exists():
            report.skip(f"the run of sample {name}", "phyxel is not built")
    report.finish()


if __name__ == "__main__":
    main()
