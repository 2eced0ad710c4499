"""Mutated inputs through child processes with limits: what the readers do with each."""

import json
import os
import select
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.fuzz.mutate import mutated

SECONDS = 10.0


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What became of one mutated input: "read", "refused", "fault", "hang" or "crash"."""

    number: int
    seed: str
    reader: str
    mutation: str
    outcome: str
    text: str

    @property
    def bad(self):
        return self.outcome in ("fault", "hang", "crash")


class Child:
    """A reading process; begun anew after a crash or a hang."""

    def __init__(self):
        self.process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("child.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            bufsize=1,
            env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"},
        )

    def ask(self, reader, path, seconds):
        """The answer to one input, or the outcome that stands for none."""
        try:
            self.process.stdin.write(f"{reader}\t{path}\n")
        except BrokenPipeError:
            return {"outcome": "crash", "text": f"exit code {self.process.wait()}"}
        ready, _, _ = select.select([self.process.stdout], [], [], seconds)
        if not ready:
            self.end()
            return {"outcome": "hang", "text": f"no answer after {seconds:g} s"}
        line = self.process.stdout.readline()
        if not line:
            return {"outcome": "crash", "text": f"exit code {self.process.wait()}"}
        return json.loads(line)

    def end(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


def run(seeds, folder, count, seed):
    """`count` mutated inputs, the seeds in turn, from random seed `seed`; the bad ones stay in `folder`."""
    blobs = [(reader, path, path.read_bytes()) for reader, path in seeds]
    child, fresh, out = Child(), True, []
    for number in range(count):
        reader, path, blob = blobs[number % len(blobs)]
        mutation, content = mutated(blob, np.random.default_rng([seed, number]))
        target = path.with_name(f"fuzz-{seed}-{number}{path.suffix}")
        if path.suffix == ".sti":  # its companions go by its name
            target = folder / f"fuzz-{seed}-{number}.sti"
            for companion in (".dof", ".mas"):
                target.with_suffix(companion).write_bytes(path.with_suffix(companion).read_bytes())
        target.write_bytes(content)
        answer = child.ask(reader, target, SECONDS + (60 if fresh else 0))
        fresh = answer["outcome"] in ("hang", "crash")
        if fresh:
            child.end()
            child = Child()
        found = Answer(number=number, seed=path.name, reader=reader, mutation=mutation, **answer)
        out.append(found)
        if not found.bad:
            target.unlink()
    child.end()
    return out


def main():
    """python -m tests.fuzz.harness FOLDER COUNT SEED [READER ...]: print what is bad."""
    from tests.fuzz.seeds import written

    folder, count, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    wanted = sys.argv[4:]
    seeds = [s for s in written(folder) if not wanted or s[0] in wanted]
    answers = run(seeds, folder, count, seed)
    for a in answers:
        if a.bad:
            print(a.outcome, a.number, a.seed, a.mutation, a.text, flush=True)
    tally = {k: sum(a.outcome == k for a in answers) for k in ("read", "refused", "fault", "hang", "crash")}
    print(tally, f"{time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
