"""Speed of a backbone: EPMC beside tmdsimpy on the same reduced matrices and friction elements, and the kernel alone.

Run `python benchmarks/backbone.py STUDY.toml [--points N] [--tmdsimpy FOLDER --python ITS_PYTHON]`. tmdsimpy
(github.com/tmd-lab/tmdsimpy, MIT) is run from its own folder by its own Python, which needs NumPy, SciPy and JAX. Each
point has one Coulomb slider that slips along one direction; with "jenkins" its normal load is constant, with "dry" it
moves. What tmdsimpy does not have (the other slip, and the normal spring of "jenkins") becomes a linear spring for
both. CPU seconds of one thread each; JAX has compiled before. Both stop at the same modal amplitude; how many points
each takes until then is its own affair and printed.
"""

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  the thread limits are read when it is loaded
from peers.peer import ask  # noqa: E402

from faying import Study  # noqa: E402
from faying.case.case import Case  # noqa: E402
from faying.joint.support_check import checked_preload  # noqa: E402
from faying.microslip.epmc import Epmc  # noqa: E402
from faying.microslip.microslip import Microslip  # noqa: E402
from faying.microslip.slip_basis import SlipBasis  # noqa: E402
from faying.microslip.slip_model import SlipJoint, SlipModel  # noqa: E402
from faying.numerics.modes import lowest_modes  # noqa: E402

MODES = 15
REPEATS = 10  # of the evaluation that is timed


def basis_of(study: Study, mode: int) -> tuple[SlipBasis, Case]:
    case = Case.of(study)
    structure = case.structure
    preload = checked_preload(structure, structure.assembly(), study.preloads[-1])
    springs = structure.springs(preload.pressures)
    modes = lowest_modes(
        structure.coupled(springs)[0],
        structure.dynamic_matrices[1],
        structure.rigid_count + MODES,
        shift_frequency=case.shift_frequency,
    )
    basis = SlipBasis(structure=structure, preload=preload, springs=springs, modes=modes, mode=mode)
    basis.begin()
    return basis, case


def laws(basis: SlipBasis, case: Case, friction: float, *, springs: int) -> list[Microslip]:
    """The laws cut into springs, or one slider a point where springs = 1."""
    out = []
    for joint, opening in zip(case.structure.joints, basis.preload.openings, strict=True):
        gap = joint.interface.gap
        if springs == 1:
            out.append(Microslip.coulomb(joint.law, -opening, friction=friction, gap=gap))
        else:
            out.append(Microslip.cut(joint.law, -opening, friction=friction, springs=springs, gap=gap))
    return out


def thinned(model: SlipModel, points: int) -> SlipModel:
    while sum(len(joint.weights) for joint in model.joints) > points:
        model = model.halved()
    return model


def along_one(model: SlipModel, mode: int, law: str) -> SlipModel:
    """Elements that slip along the direction in which the mode moves most; all else as linear springs."""
    shape = model.modes[1][:, mode]
    stiffness, joints = model.stiffness.copy(), []
    for joint in model.joints:
        _, tangent = joint.at_rest
        rows = joint.relative.reshape(len(joint.weights), 3, -1)
        moves = np.abs(np.einsum("qim,m->qi", rows, shape)).sum(axis=0)
        linear = [1 if moves[2] > moves[1] else 2] + ([0] if law == "jenkins" else [])
        kept = rows.copy()
        for i in linear:
            k = joint.weights * tangent[:, i, i]
            stiffness += np.einsum("qm,q,qn->mn", rows[:, i], k, rows[:, i])
            kept[:, i] = 0.0
        joints.append(replace(joint, relative=kept.reshape(joint.relative.shape)))
    return replace(model, stiffness=stiffness, joints=tuple(joints))


def elements(joint: SlipJoint) -> dict[str, np.ndarray]:
    """Rows of slip and closing, stiffnesses [N/m] and closing at rest [m] of the points that are closed."""
    rows = joint.relative.reshape(len(joint.weights), 3, -1)
    slip = rows[:, 1] + rows[:, 2]  # one of them is 0
    depth = joint.law.approach(joint.rest) - joint.law.onset[:, 0]
    k_n, k_t = (joint.weights * k[:, 0] for k in (joint.law.k_n, joint.law.k_t))
    return {"slip": slip, "closing": -rows[:, 0], "k_t": k_t, "k_n": k_n, "depth": depth}


def ours(model: SlipModel, mode: int, low: float, high: float, samples: int) -> tuple[float, np.ndarray, Epmc]:
    start = time.process_time()
    epmc = Epmc(model=model, mode=mode, harmonics=3, samples=samples)
    curve = epmc.follow(low, high)
    seconds = time.process_time() - start
    found = np.array([(p.amplitude, p.frequency, p.damping) for p in curve.points])
    last = curve.points[-1]
    print(
        f"  faying    {seconds:8.2f} s CPU  {len(found):3d} points ({curve.code}), frequency "
        f"{last.frequency / epmc.linear_frequency - 1:+.2%}, damping {last.damping:.2%}, slipping {last.slipping:.0%}"
    )
    return seconds, found, epmc


def theirs(
    model: SlipModel, mode: int, law: str, low: float, high: float, samples: int, most: int, **where: Any
) -> tuple[dict[str, Any], np.ndarray, np.ndarray]:
    """What tmdsimpy finds, and a trial motion (7, m) with the forces (7, m) of the same elements by Faying.

    where: its interpreter, and what `ask` takes; the others as for `ours`.
    """
    parts = [elements(joint) for joint in model.joints]
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    omega, shapes = model.modes
    count, size = 7, len(model.mass)
    motion = np.random.default_rng(1).normal(size=(count, size)) * high / 3 @ shapes.T
    static = sum(
        joint.relative.T @ (joint.weights[:, None] * joint.at_rest[0] * [1, 0, 0]).ravel() for joint in model.joints
    )
    found = ask(
        witness="backbone.py",
        **where,
        **joined,
        law=law,
        mass=model.mass,
        stiffness=model.stiffness,
        friction=model.joints[0].law.friction,
        frequency=omega[mode],
        shape=shapes[:, mode],
        trial=motion,
        static=static,
        low=low,
        high=high,
        samples=samples,
        harmonics=3,
        most=most,
    )
    forces = model.forces(motion, derivative=False, samples=samples).force - motion @ model.stiffness
    forces[0] += static
    return dict(found) | {"forces": found["forces"].reshape(count, size)}, motion, forces


def timed(model: SlipModel, mode: int, law: str, *limits: float, **where: Any) -> tuple[float, np.ndarray]:
    """Print the times of tmdsimpy, and return its seconds and its curve."""
    *_, high, samples, _ = limits
    found, motion, forces = theirs(model, mode, law, *limits, **where)
    start = time.process_time()
    for _ in range(REPEATS):
        model.forces(motion, samples=int(samples))
    each = (time.process_time() - start) / REPEATS
    miss = np.abs(found["forces"] - forces).max() / np.abs(forces[1:]).max()
    curve = np.stack([found["amplitude"], found["frequency"], found["damping"]], axis=1)
    print(
        f"  tmdsimpy  {found['seconds']:8.2f} s CPU  {len(curve):3d} points to {curve[-1, 0] / high:.2f} of the last "
        f"amplitude, {found['wall']:.1f} s wall; forces of a trial motion differ by {miss:.1e}"
    )
    print(
        f"  one evaluation of forces and derivative, every point slipping: {1e3 * each:.1f} ms, tmdsimpy "
        f"{1e3 * float(found['evaluation']):.1f} ms, ratio {float(found['evaluation']) / each:.0f}"
    )
    return float(found["seconds"]), curve


def compare(own: np.ndarray, other: np.ndarray) -> None:
    """Print both curves where both have one; tmdsimpy's is interpolated between its points."""
    other = other[np.argsort(other[:, 0])]
    inside = own[(own[:, 0] >= other[0, 0]) & (own[:, 0] <= other[-1, 0])]
    x = np.log(inside[:, 0])
    frequency, damping = (np.interp(x, np.log(other[:, 0]), other[:, i]) for i in (1, 2))
    print("  amplitude [m kg^1/2]   frequency less the first [1e-6]      damping [1e-6]: faying, tmdsimpy")
    for row, f, z in zip(inside, frequency, damping, strict=True):
        ours_, theirs_ = ((value / own[0, 1] - 1) * 1e6 for value in (row[1], f))
        print(f"  {row[0]:12.4g}  {ours_:16.1f} {theirs_:12.1f}  {row[2] * 1e6:16.1f} {z * 1e6:12.1f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Path)
    parser.add_argument("--mode", type=int, default=1)
    parser.add_argument("--friction", type=float, default=0.2)
    parser.add_argument("--points", type=int, default=120, help="of the joints, beside tmdsimpy")
    parser.add_argument("--high", type=float, default=50.0, help="greatest acceleration where it is greatest [m/s2]")
    parser.add_argument("--decades", type=float, default=2.0)
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--laws", nargs="+", default=["microslip", "jenkins", "dry"])
    parser.add_argument("--most", type=int, default=60, help="points of tmdsimpy's curve")
    parser.add_argument("--tmdsimpy", type=Path)
    parser.add_argument("--python", default="python")
    given = parser.parse_args()
    start = time.process_time()
    basis, case = basis_of(Study.read(given.study), given.mode)
    mode = given.mode - 1
    frequency = basis.modes.frequencies[basis.structure.rigid_count + mode]
    print(
        f"preload, modes, first basis: {time.process_time() - start:.1f} s CPU; mode {given.mode} at {frequency:.2f} Hz"
    )
    omega = 2 * np.pi * frequency
    high = given.high / (np.abs(basis.shape).max() * omega**2)
    low = high / 10**given.decades

    if "microslip" in given.laws:
        full = basis.model(laws(basis, case, given.friction, springs=32))
        points = sum(len(joint.weights) for joint in full.joints)
        print(f"microslip law, {points} points, {len(full.mass)} coordinates, 32 springs, 64 instants")
        ours(full, mode_index(full, omega), low, high, 64)

    one = thinned(basis.model(laws(basis, case, given.friction, springs=1)), given.points)
    for law in [name for name in ("jenkins", "dry") if name in given.laws]:
        model = along_one(one, mode_index(one, omega), law)
        mode = mode_index(model, omega)
        points = sum(len(joint.weights) for joint in model.joints)
        print(f"{law}: {points} points, {len(model.mass)} coordinates, one slider, {given.samples} instants")
        seconds, own, _ = ours(model, mode, low, high, given.samples)
        if given.tmdsimpy is not None:
            where = {"python": given.python, "path": given.tmdsimpy, "before": ("taskset", "-c", "0")}
            other, curve = timed(model, mode, law, low, high, given.samples, given.most, **where)
            each = other / len(curve) / (seconds / len(own))
            print(f"  ratio of CPU seconds: {other / seconds:.0f} per curve, {each:.0f} per point of it")
            compare(own, curve)


def mode_index(model: SlipModel, omega: float) -> int:
    return int(np.argmin(np.abs(model.modes[0] - omega)))


if __name__ == "__main__":
    main()
