"""Faying and other codes on the same problems: one table.

    python benchmarks/peers [--list] [--markdown] [--only WORD ...] [--python PYTHON]

Each row has a quantity by Faying and by the other code, their relative difference, and a bound that was justified
before the comparison: by the theory, by the tolerances and printed digits of both, or by the tests. --list shows the
problems with the reasons of their bounds. PYTHON is an interpreter that has the packages (else that of FAYING_PEERS, or
this one); every code runs in a process of its own, on one thread, and none with a GPL is imported here. A code that is
not there is named and left out. All takes some 5 minutes of CPU; --only takes words of the problems or codes.
"""

import argparse
import os
import sys
import textwrap
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
ROOT = Path(__file__).parents[2]
if not __package__:
    sys.path[:1] = [str(ROOT / "benchmarks"), str(ROOT)]

from peers.peer import PEERS, interpreter, present  # noqa: E402  the paths come first
from peers.problems import PROBLEMS  # noqa: E402
from peers.rows import cells, markdown, plain  # noqa: E402


def main(words: list[str] | None = None) -> int:
    """Print the table; 1 where a code fails."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--list", action="store_true", help="only the problems, and why their bounds are what they are")
    ask.add_argument("--markdown", action="store_true", help="the table of docs/peers.md")
    ask.add_argument("--only", nargs="+", metavar="WORD", help="problems or codes with one of these words")
    ask.add_argument("--python", help="interpreter that has the packages")
    given = ask.parse_args(words)
    wanted = [
        problem
        for problem in PROBLEMS
        if not given.only or any(word.lower() in f"{problem.name} {problem.peer}".lower() for word in given.only)
    ]
    if given.list:
        for problem in wanted:
            print(f"{problem.name}, {problem.peer}, {problem.seconds:g} s")
            print(textwrap.fill(problem.bound, 110, initial_indent="    ", subsequent_indent="    "))
        return 0
    python = interpreter(given.python)
    there = present(python)
    rows, failed, lacking = [], 0, [name for name in PEERS if name not in there]
    for problem in wanted:
        if problem.peer in lacking:
            continue
        begin = time.perf_counter()
        try:
            found = [cells(problem, row) for row in problem.solve(python)]
        except RuntimeError as fault:
            failed += 1
            print(f"{problem.name}, {problem.peer} failed: {fault}", file=sys.stderr)
            continue
        rows += found
        print(f"{problem.name}, {problem.peer}: {time.perf_counter() - begin:.1f} s", file=sys.stderr)
    print((markdown if given.markdown else plain)(rows))
    versions = [f"{name} {version}".strip() for name, version in there.items() if PEERS[name].licence]
    print(f"\nVersions: {', '.join(versions)}.")
    for name in lacking:
        print(f"not installed: {name}: {PEERS[name].get}")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
