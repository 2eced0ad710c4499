"""A sweep beside one full solution: 1,000 laws and preloads of the T-specimen, in one run.

    python benchmarks/sweep.py [--size 150] [--checks 20]

CPU seconds on one thread of: one full solution (matrices, preload, real and complex modes at one load), the making of
the bases, 1,000 evaluations; then full solutions at random points, half of them outside the ranges of the sweep, and
the largest difference of a frequency.
"""

import argparse
import os
import time
from dataclasses import replace

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  the thread counts come first
from structures import EDGES, ROOT  # noqa: E402

AXES = ("surface.D=2.3:2.5:10", "surface.G='5e-11 m:5e-10 m:10:log'", "bolt.preload='4 kN:12 kN:10'")
OUTSIDE = ("surface.D=2.26:2.54:7", "surface.G='3e-11 m:8e-10 m:7:log'", "bolt.preload='3 kN:14 kN:7'")


def full(structure, laws, forces, count):
    """The same variant with the full matrices: frequencies of the complex modes."""
    from faying.joint.modal import SPARE_MODES
    from faying.numerics.damped import damped_modes
    from faying.numerics.modes import lowest_modes

    joints = tuple(replace(joint, law=law) for joint, law in zip(structure.joints, laws, strict=True))
    variant = replace(structure, joints=joints)
    found = variant.assembly().solve(variant.loads @ forces)
    K, loss = variant.coupled(variant.springs(found.pressures))
    M, still = variant.dynamic_matrices[1], variant.rigid.shape[1]
    modes = lowest_modes(K, M, still + count + SPARE_MODES, shift_frequency=variant.shift_frequency)
    return damped_modes(modes, K, M, loss, rigid=still, count=count).frequencies


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--size", type=int, default=150, choices=sorted(EDGES))
    ask.add_argument("--checks", type=int, default=20)
    given = ask.parse_args()
    from faying.case.case import checked_mesh, structure_of, surfaces_of
    from faying.study import Study
    from faying.sweeps.axes import Grid, axis_of
    from faying.sweeps.sweep import evaluate
    from faying.sweeps.trainer import Trainer
    from faying.sweeps.variant_builder import VariantBuilder

    plan = Study.read(ROOT / "examples/t-specimen/study.toml")
    edge, at_joint = EDGES[given.size]
    plan = replace(plan, geometry=replace(plan.geometry, size=edge * 1e-3, face_size={"upper.joint": at_joint * 1e-3}))
    mesh, surfaces = checked_mesh(plan), surfaces_of(plan)
    pairs = tuple(tuple(plan.materials[plan.parts[mesh.face_part[f]]] for f in joint.faces) for joint in plan.joints)
    near, wide = (
        VariantBuilder(
            design=Grid(study=plan, surfaces=surfaces, axes=tuple(axis_of(t.replace("'", "")) for t in texts)),
            pairs=pairs,
        )
        for texts in (AXES, OUTSIDE)
    )
    clock = time.process_time
    structure = structure_of(plan, mesh, surfaces)

    begin = clock()
    structure.dynamic_matrices, structure.loads, structure.rigid  # noqa: B018
    laws, forces, _ = near.laws(near.design.size // 2 + 5)
    full(structure, laws, forces, plan.modes.count)
    single = clock() - begin
    print(f"{mesh.unknowns:,} unknowns: one full solution {single:.1f} CPU s", flush=True)

    begin = clock()
    model = Trainer(plan, structure, near, 4e-6, lambda *_: None).model()
    training = clock() - begin
    print(
        f"bases of {len(model.static_stiffness)} and {len(model.dynamic_mass)} vectors: {training:.1f} CPU s, "
        f"{training / single:.2f} of a full solution",
        flush=True,
    )
    begin = clock()
    rows = evaluate(model, near, near.design.winding())
    online = clock() - begin
    answered = np.isfinite(rows["frequencies"][:, 0]).sum()
    print(
        f"{near.design.size} evaluations: {online:.1f} CPU s, {online / single:.2f} of a full solution; {answered} "
        f"answered",
        flush=True,
    )

    generator = np.random.default_rng(0)
    for where, recipe, share in (("inside", near, 2), ("outside", wide, 2)):
        differ = []
        while len(differ) < given.checks // share:
            index = int(generator.integers(recipe.design.size))
            inner = [
                0 < i < n - 1
                for i, n in zip(np.unravel_index(index, recipe.design.shape), recipe.design.shape, strict=True)
            ]
            got = evaluate(model, recipe, [index])["frequencies"][0]
            if (where == "outside" and all(inner)) or not np.isfinite(got[0]):
                continue
            laws, forces, _ = recipe.laws(index)
            differ.append(float(np.abs(got / full(structure, laws, forces, plan.modes.count) - 1).max()))
        print(
            f"{len(differ)} random points {where} the ranges: frequencies differ by {max(differ):.1e} at most",
            flush=True,
        )


if __name__ == "__main__":
    main()
