"""How the check scripts say what they found: one line a check, `ok NAME` or `FAIL NAME: reason`, which run_tests.py counts."""

import concurrent.futures
import os
import sys


class Report:
    def __init__(self):
        self.failures = 0

    def check(self, name, problem=""):
        """Reports the check `name`; a non-empty `problem` says why it failed."""
        if problem:
            self.failures += 1
            print(f"FAIL {name}: {problem}", flush=True)
        else:
            print(f"ok {name}", flush=True)
        return not problem

    def skip(self, name, reason):
        print(f"skip {name}: {reason}", flush=True)

    def finish(self):
        """Ends the program: 0 when nothing failed."""
        sys.exit(1 if self.failures else 0)


def side_by_side(task, items):
    """`task` of each item, in their order; as many at a time as the machine has processors."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(task, items)
