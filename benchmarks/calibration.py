"""Whether intervals of an identification hold what they say: truths from the priors, a test made of each, identified.

    python benchmarks/calibration.py [--study examples/two-blocks/uncertain.toml] [--truths 30] [--waves]

For each truth the model itself gives the frequencies; offset and scatter are drawn from their priors, too. With --waves
k_t/k_n and E are unknown as well, and the faces of each truth have waves of their own, of which the model has none:

    python benchmarks/calibration.py --study examples/parts-first/bolted.toml --waves

Printed are the share of truths inside the 5 to 95 % intervals, for each parameter and for all, and the chi-square of
the ranks in five bins (Talts et al. 2018, arXiv:1804.06788).
"""

import argparse
import math
import os
import time
from dataclasses import replace
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  the thread counts come first

ROOT = Path(__file__).parent.parent
BINS = 5


class PartFile:
    """A model that remembers where it was evaluated: all truths share the points over the priors."""

    def __init__(self, model):
        self.model, self.known = model, {}
        self.names, self.units, self.priors = model.names, model.units, model.priors

    def frequencies(self, values, report=None, allowed=math.inf):
        key = values.tobytes()
        if key not in self.known:
            self.known[key] = self.model.frequencies(values, report, allowed)
        return self.known[key]

    def own_errors(self):
        return self.model.own_errors()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", type=Path, default=ROOT / "examples" / "two-blocks" / "uncertain.toml")
    parser.add_argument("--truths", type=int, default=30)
    parser.add_argument("--waves", action="store_true")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()

    from faying.case.case import build, surfaces_of
    from faying.case.scatter import with_assumed
    from faying.distribution import Distribution
    from faying.identify.identify import identify_model, points_for
    from faying.identify.noise import DISCREPANCY_SD, TEST_SD
    from faying.identify.of_study import StudyModel, _Stage
    from faying.identify.sampling.ensemble import Ensemble
    from faying.identify.sampling.evaluate import Reduced
    from faying.identify.sampling.points import at_shares, sobol
    from faying.study import Study
    from faying.study.keys.uncertain import Input

    study, more, waves = Study.read(given.study), [], []
    if given.waves:
        silent = [replace(joint, form=None, tangential="mindlin") for joint in study.joints]
        bare = replace(study, joints=tuple(silent), uncertain=None)
        found = with_assumed(bare, build(bare), surfaces_of(bare)).inputs
        waves = [one for one in found if ".waviness" in one.key]
        more = [one for one in found if one.key.endswith(".tangential")]
        modulus = study.materials[next(iter(study.parts.values()))].E
        steel = Distribution(kind="normal", centre=modulus, spread=0.03 * modulus)
        more.append(Input(key=f"material.{next(iter(study.parts.values()))}.E", distribution=steel, unit="Pa"))
        study = replace(study, joints=tuple(silent))
    began = time.process_time()
    stage = _Stage(None)

    def model_with(more):
        choice = study.uncertain
        ensemble = Ensemble.of(replace(study, uncertain=replace(choice, inputs=(*choice.inputs, *more))), 8, given.seed)
        return StudyModel(ensemble, Reduced(ensemble, report=stage), stage)

    model = PartFile(model_with(more))
    true_model = model_with([*more, *waves]) if waves else model.model
    print(f"bases: {time.process_time() - began:.0f} CPU s", flush=True)
    # the points over the priors come first: they settle which modes are the test's
    size = len(model.names)
    model.frequencies(at_shares(model.priors, sobol(size, points_for(size), given.seed)))
    true_model.frequencies(at_shares(true_model.priors, sobol(len(true_model.priors), 64, given.seed)))
    rng = np.random.default_rng([given.seed, 1])
    loads = np.array(study.loads)
    ranks, started = [], time.process_time()
    # truths fill the priors evenly: what a test does not see has the rank that its truth has in the prior
    priors = (*true_model.priors, TEST_SD, DISCREPANCY_SD)
    for row in at_shares(priors, sobol(len(priors), given.truths, given.seed + 1)):
        truth, (sd, bias) = row[:size], row[-2:]
        found, reasons = true_model.frequencies(row[None, :-2])
        if reasons[0] or not np.isfinite(found).any():  # modes that waves mix have no partner
            print(f"no answer at {truth}: {reasons[0]}", flush=True)
            continue
        both = zip((bias, sd), model.own_errors(), strict=True)
        bias_of_all, sd_of_all = (np.hypot(one, own) for one, own in both)
        noise = bias_of_all * rng.standard_normal(found.shape[2]) + sd_of_all * rng.standard_normal(found.shape[1:])
        answer = identify_model(model, found[0] * np.exp(noise), loads, seed=given.seed)
        ranks.append((answer.samples[:, : size + 2] < [*truth, sd, bias]).mean(axis=0))
        print(len(ranks), " ".join(f"{rank:.2f}" for rank in ranks[-1]), flush=True)
    ranks = np.array(ranks)
    inside = (ranks > 0.05) & (ranks < 0.95)
    expected = len(ranks) / BINS
    for name, column, within in zip((*model.names, "test scatter", "discrepancy"), ranks.T, inside.T, strict=True):
        counts = np.histogram(column, bins=BINS, range=(0, 1))[0]
        print(f"{name:<28} inside {within.mean():.2f}  chi-square {((counts - expected) ** 2 / expected).sum():.1f}")
    print(f"all: inside {inside.mean():.3f}; {(time.process_time() - started) / len(ranks):.1f} CPU s a truth")


if __name__ == "__main__":
    main()
