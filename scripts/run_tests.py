#!/usr/bin/env python3
"""`./dev test`: runs every check, build and test in stages, prints the time of each, and ends with a line
`N passed, N failed`. `--long` adds the slow tests; `--only STAGE` (or `checks`) runs that alone."""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parent.parent
JOBS = str(os.cpu_count())
SUPPRESSIONS = ROOT / "scripts" / "suppressions"
SANITIZER_ENVIRONMENT = {
    "ASAN_OPTIONS": "detect_stack_use_after_return=1:strict_init_order=1",
    "LSAN_OPTIONS": f"suppressions={SUPPRESSIONS / 'lsan.txt'}:print_suppressions=0",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    "TSAN_OPTIONS": f"suppressions={SUPPRESSIONS / 'tsan.txt'}:halt_on_error=1:second_deadlock_stack=1",
}


class Totals:
    passed = failed = 0
    names = []

    @classmethod
    def add(cls, name, ok):
        if ok:
            cls.passed += 1
        else:
            cls.failed += 1
            cls.names.append(name)


def run_checks(*command, environment=None):
    """Runs a script that prints `ok NAME` and `FAIL NAME: reason` lines, and counts them. One that ends badly without
    a FAIL line, or checks nothing, is itself a failure."""
    name = " ".join(str(part) for part in command)
    process = subprocess.Popen(
        [str(part) for part in command], cwd=ROOT, env={**os.environ, **(environment or {})},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    )
    passed = failed = 0
    for line in process.stdout:
        if line.startswith("ok "):
            passed += 1
            Totals.add(line.strip(), True)
            continue
        if line.startswith("FAIL "):
            failed += 1
            Totals.add(line.strip().removeprefix("FAIL "), False)
        print("  " + line, end="", flush=True)
    if (process.wait() != 0 or passed == 0) and failed == 0:
        Totals.add(f"{name} ended with code {process.returncode}, having checked {passed}", False)
    print(f"  {passed} passed, {failed} failed")


def run_command(name, *command, environment=None):
    """Runs a command that counts as one check; its output is shown only when it fails."""
    result = subprocess.run(
        [str(part) for part in command], cwd=ROOT, env={**os.environ, **(environment or {})},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    )
    Totals.add(name, result.returncode == 0)
    if result.returncode != 0:
        print(result.stdout[-20000:])
        print(f"  FAIL {name}: {' '.join(str(part) for part in command)} ended with code {result.returncode}")
    return result.returncode == 0


def run_unit_tests(preset, environment=None, label="", slow=""):
    """Runs the unit tests of a preset through ctest: all but those labelled long, or `label`, without the `slow` ones."""
    results = ROOT / "build" / preset / "unit_tests.xml"
    results.unlink(missing_ok=True)
    select = ["-L", label] if label else ["-LE", "long"]
    if slow:
        select += ["-E", slow]
    subprocess.run(
        ["ctest", "--test-dir", f"build/{preset}", "--parallel", JOBS, "--timeout", "3600" if label else "1500",
         "--output-on-failure", "--quiet", "--output-junit", str(results), *select],
        cwd=ROOT, env={**os.environ, **(environment or {})}, stdout=subprocess.DEVNULL,
    )
    if not results.exists():
        return Totals.add(f"{preset}: ctest wrote no results", False)
    passed = failed = 0
    for case in xml.parse(results).getroot().iter("testcase"):
        status = case.get("status")
        if status in ("disabled", "notrun"):
            continue
        ok = status == "run" and case.find("skipped") is None
        passed, failed = passed + ok, failed + (not ok)
        Totals.add(f"{preset}: {case.get('name')}", ok)
        if not ok:
            print(f"  FAIL {preset}: {case.get('name')}\n{(case.findtext('system-out') or '')[-6000:]}")
    if passed + failed == 0 and not label:
        Totals.add(f"{preset}: no unit test was found", False)
    print(f"  {passed} passed, {failed} failed")


# --- the stages, in the order in which they run


def stage_format(options):
    run_command("format", "./dev", "format", "--check")


def stage_includes(options):
    run_checks("python3", "scripts/check_includes.py")


def stage_text(options):
    run_checks("python3", "scripts/check_text.py")


def stage_docs(options):
    run_checks("python3", "scripts/check_docs.py")


def stage_build(options):
    run_command("release build, warnings as errors", "./dev", "build", "release")


def stage_unit(options):
    run_unit_tests("release")


def stage_samples(options):
    run_checks("python3", "scripts/check_samples.py")


def stage_install(options):
    run_checks("python3", "scripts/check_install.py")


def stage_scenes(options):
    run_checks("python3", "scripts/run_scenes.py", *(["--long"] if options.long else []))


def stage_meshes(options):
    run_checks("python3", "scripts/test_meshes.py", *([] if options.long else ["--sample", "3"]))


def stage_asan(options):
    # Long motions take minutes each under the sanitizers and run through the same code as the others: with --long only.
    slow = "" if options.long else (
        "Modes|BarOnRollers|TractionPatch|Promise|Energy|Bounce|Resting|Motion|StableStep|Equilibrium|Regions|Studies|"
        "ImplicitStep.(of_any|of_second|from_a|gives)|TurnedBeams|Manufactured|SolverEffort|Sag|"
        "MeetingBodies.(rest|hold|have|that_pile)|SolverSettings.(of_every|of_one)|Refusals.name_a_spacing|Sampling.count")
    if run_command("asan build", "./dev", "build", "asan"):
        run_unit_tests("asan", SANITIZER_ENVIRONMENT, slow=slow)


def stage_tsan(options):
    # The loops themselves, and a body that runs through all of them with one thread and with three.
    if run_command("tsan build", "./dev", "build", "tsan", "--target", "test_all_loops"):
        run_command("tsan: test_all_loops", "build/tsan/bin/test_all_loops", environment=SANITIZER_ENVIRONMENT)
    check_that_races_are_found()


def check_that_races_are_found():
    """A program with a race must be reported: the suppressions do not hide what happens inside parallel loops."""
    program = ROOT / "build" / "tsan" / "race"
    sources = ["tests/sanitizers/race.cpp", "src/base/threads.cpp"]
    if run_command("tsan: the race builds", "g++", "-std=c++20", "-O1", "-g", "-fsanitize=thread", "-Isrc", "-Iinclude",
                   *sources, "-o", program, "-ltbb"):
        result = subprocess.run([program], env={**os.environ, **SANITIZER_ENVIRONMENT}, capture_output=True, text=True)
        found = "WARNING: ThreadSanitizer: data race" in result.stderr
        Totals.add("tsan: a race in a parallel loop is reported", found)
        if not found:
            print("  FAIL tsan: a race in a parallel loop is reported: it was not")


def stage_long(options):
    if options.long:
        run_unit_tests("release", label="long")


STAGES = {name.removeprefix("stage_"): stage for name, stage in list(globals().items()) if name.startswith("stage_")}
CHECKS = ("format", "includes", "text", "docs", "samples")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="also what takes longer")
    parser.add_argument("--only", action="append", metavar="STAGE", choices=[*STAGES, "checks"], help="may be repeated")
    options = parser.parse_args()
    only = set(options.only or STAGES) | (set(CHECKS) if "checks" in (options.only or []) else set())

    bold = ("\033[1m", "\033[0m") if sys.stdout.isatty() else ("", "")
    begin = time.monotonic()
    for name, stage in STAGES.items():
        if name not in only or (name == "long" and not options.long):
            continue
        print(f"{bold[0]}{name}{bold[1]}", flush=True)
        stage_begin = time.monotonic()
        stage(options)
        print(f"  {time.monotonic() - stage_begin:.1f} s", flush=True)

    for name in Totals.names:
        print(f"failed: {name}")
    print(f"all stages: {time.monotonic() - begin:.0f} s")
    print(f"{Totals.passed} passed, {Totals.failed} failed")
    sys.exit(1 if Totals.failed else 0)


if __name__ == "__main__":
    main()
