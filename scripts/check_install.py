#!/usr/bin/env python3
"""Installs the release build into an empty prefix and builds tests/install against it, as another project would: it
finds phyxel::phyxel by find_package, runs the lines of the README, and the installed program answers."""

import pathlib
import subprocess
import tempfile

from report import Report

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    report = Report()

    def run(name, *command):
        result = subprocess.run([str(part) for part in command], cwd=ROOT, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)
        if not report.check(name, f"ended with code {result.returncode}" if result.returncode else ""):
            print(result.stdout[-6000:])
            report.finish()

    with tempfile.TemporaryDirectory() as folder:
        prefix, build = pathlib.Path(folder) / "prefix", pathlib.Path(folder) / "build"
        run("install into an empty prefix", "cmake", "--install", "build/release", "--prefix", prefix)
        run("the installed program answers", prefix / "bin" / "phyxel", "--version")
        run("another project finds phyxel::phyxel", "cmake", "-S", "tests/install", "-B", build, "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={prefix}", f"-DPHYXEL_MESH={ROOT / 'scenes' / 'meshes' / 'bunny.obj'}")
        run("another project builds", "cmake", "--build", build)
        run("the lines of the README run", build / "readme")
    report.finish()


if __name__ == "__main__":
    main()
