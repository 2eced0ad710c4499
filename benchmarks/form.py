"""What the form of the faces costs: CPU seconds of a study with flat faces and with a form, in one run.

    python benchmarks/form.py [--only t-specimen|brake-reuss]

The T-specimen with a crown of 14 um, and the Brake-Reuss beam with its measured form where its data have been written
(examples/brake-reuss-beam/make_data.py). For each: the preload alone and the whole run, what the preload took, and the
ratio to the flat faces.
"""

import argparse
import os
import time
from dataclasses import replace

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

from structures import ROOT  # noqa: E402  the thread counts come first


def measured(study):
    """CPU seconds of the preload at all loads and of the whole run; what the preload took."""
    from faying.answer.run import run
    from faying.case.case import build
    from faying.joint.support_check import checked_preload

    structure = build(study)
    structure.dynamic_matrices, structure.loads, structure.rigid  # noqa: B018
    begin = time.process_time()
    problem = structure.assembly()
    found = [checked_preload(structure, problem, one) for one in study.preloads]
    preload = time.process_time() - begin
    begin = time.process_time()
    run(study)
    return preload, time.process_time() - begin, found


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--only", choices=("t-specimen", "brake-reuss"))
    given = ask.parse_args()
    from faying.form.form import Form
    from faying.study import Study

    flat = Study.read(ROOT / "examples/t-specimen/study.toml")
    crowned = replace(flat, joints=(replace(flat.joints[0], form=Form(crown_along=14e-6)),))
    pairs = {"t-specimen": (flat, crowned)}
    beam = ROOT / "examples/brake-reuss-beam"
    if (beam / "data/gap-map.csv").is_file():
        pairs["brake-reuss"] = Study.read(beam / "flat.toml"), Study.read(beam / "measured-form.toml")
    for name, studies in pairs.items():
        if given.only not in (None, name):
            continue
        times = []
        for what, study in zip(("flat", "form"), studies, strict=True):
            preload, whole, found = measured(study)
            times.append((preload, whole))
            newton, inner = (sum(getattr(f, kind) for f in found) for kind in ("newton_steps", "inner_steps"))
            print(
                f"{name}, {what}: preload {preload:.1f} s ({newton} Newton steps, {inner} inner steps, "
                f"{found[-1].factorisations} factorisations), run {whole:.1f} s",
                flush=True,
            )
        (a, b), (c, d) = times
        print(f"{name}: form over flat {c / a:.2f} in the preload, {d / b:.2f} in the run", flush=True)


if __name__ == "__main__":
    main()
