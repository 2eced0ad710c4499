"""The modes and FRFs of a result as universal files, for the programs that test engineers use."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from faying.errors import InputError
from faying.measured.frf import FRF, Dof
from faying.measured.modes import ModeSet
from faying.measured.uff_write import write_uff
from faying.result import Receptance, Result
from faying.result.response_figure import axis_name
from faying.study.keys.solution import ResponseChoice
from faying.typing import Array
from faying.units import load_text

MAX_POINTS = 400
TEST_FILES = ("test_modes.uff", "test_frf.uff")


def check(spec: ResponseChoice | None) -> None:
    """Raise InputError for a response along a direction that no universal file can state."""
    for point, axis in (*spec.inputs, *spec.outputs) if spec else ():
        if axis_name(axis) is None:
            raise InputError(
                f"response: the direction {list(axis)} at {[f'{1e3 * v:g} mm' for v in point]} is along none of x, "
                f"y, z, the only "
                "ones of data set 58; turn it, or leave out --uff"
            )


def write(result: Result, folder: Path) -> list[Path]:
    """Write modes.uff (55) and, where there is a response, frf.uff (58); the same again at the points of the test.

    modes.uff: the last preload, at the points of [response], numbered from 1, and at up to 400 others spread over the
    outline. frf.uff: accelerance at the last preload, points numbered alike. Both lie in the frame of the model.
    test_modes.uff and test_frf.uff: the model at the preload of the test, in the test's numbers and frame.
    """
    response = result.response
    ends = () if response is None else (*response.inputs, *response.outputs)
    labels = {point: k for k, point in enumerate(dict.fromkeys(tuple(p) for p, _ in ends), 1)}
    nearest = [int(np.argmin(np.linalg.norm(result.outline - np.array(point), axis=1))) for point in labels]
    nodes = _spread(result.outline, nearest)
    positions = {k + 1: tuple(float(v) for v in result.outline[node]) for k, node in enumerate(nodes)}
    positions |= {k: p for p, k in labels.items()}
    title = f"{result.title}, {result.load_names[-1]}"
    modes = _modes(result.frequencies[-1], _losses(result), result.shapes[-1][:, nodes].astype(float), positions)
    made = [write_uff(folder / "modes.uff", modes, title=title)]
    if response is not None:
        made.append(write_uff(folder / "frf.uff", _frf(response, labels), title=title))
    return made + _at_test(result, folder)


def _at_test(result: Result, folder: Path) -> list[Path]:
    comparison = result.hammer
    if comparison is None:
        return []
    model, points = comparison.model, comparison.point_map
    title = f"{model.title}, {load_text(model.load)}, at the points of the test"
    labels = list(points.nodes)
    # shapes in the axes of the test: x_test = rotation^T x_model
    shapes = model.shapes[:, [comparison.places[k] for k in labels]] @ points.transform.rotation
    positions = {k: comparison.test.positions[k] for k in labels}
    made = [
        write_uff(folder / TEST_FILES[0], _modes(model.frequencies, model.loss_factors, shapes, positions), title=title)
    ]
    if comparison.frf is not None and comparison.predicted is not None:
        frf = comparison.frf
        pairs = np.zeros(comparison.predicted.shape[:2], dtype=bool)
        for pair in frf.measured:
            pairs[pair] = True
        lines = np.isfinite(comparison.predicted[pairs]).all(axis=0)
        if lines.sum() >= 2:
            values = np.where(pairs[:, :, None], comparison.predicted, np.nan)[:, :, lines]
            of_model = FRF(
                frequency=frf.frequency[lines],
                values=values,
                outputs=frf.outputs,
                inputs=frf.inputs,
                quantity=frf.quantity,
                positions=positions,
            )
            made.append(write_uff(folder / TEST_FILES[1], of_model, title=title))
    return made


def _losses(result: Result) -> Array:
    """Loss factors at the last preload; where the laws give none, twice the damping at the middle level, or 0."""
    losses: Array = result.loss_factors[-1]
    if result.levels is None:
        return np.nan_to_num(losses)
    middle = len(result.levels.accelerations) // 2
    return np.asarray(np.where(np.isnan(losses), 2 * result.levels.damping[-1, middle], losses))


def _modes(frequencies: Array, losses: Array, shapes: Array, positions: Mapping[int, tuple[float, ...]]) -> ModeSet:
    """Shapes (m, p, 3) at the points of `positions`, in their order."""
    dofs = tuple(Dof(label, axis) for label in positions for axis in "xyz")
    return ModeSet(
        frequencies=frequencies,
        loss_factors=losses,
        shapes=shapes.reshape(len(shapes), -1).astype(complex),
        dofs=dofs,
        positions=positions,  # type: ignore[arg-type]
    )


def _frf(response: Receptance, labels: dict[tuple[float, ...], int]) -> FRF:
    rows: dict[Dof, int] = {}
    columns: dict[Dof, int] = {}
    for side, known in ((response.outputs, rows), (response.inputs, columns)):
        for k, (point, axis) in enumerate(side):
            known.setdefault(Dof(labels[tuple(point)], axis_name(axis) or ""), k)
    values = response.values[-1][:, list(rows.values())][:, :, list(columns.values())].transpose(1, 2, 0)
    receptance = FRF(
        frequency=response.frequencies,
        values=values,
        outputs=tuple(rows),
        inputs=tuple(columns),
        quantity="receptance",
        positions={k: p for p, k in labels.items()},  # type: ignore[misc]
    )
    return receptance.to("accelerance")


def _spread(points: Array, first: list[int]) -> list[int]:
    """`first`, then points each as far as can be from all before it, up to MAX_POINTS in all.

    Points that coincide with another, as nodes of two faces in a joint do, are left out: a position would not tell
    which of the two is meant.
    """
    from scipy.spatial import KDTree

    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    single = np.ones(len(points), dtype=bool)
    single[KDTree(points).query_pairs(1e-6 * size, output_type="ndarray").ravel()] = False
    chosen = list(first) or [int(np.argmin(np.where(single, points @ [1.0, 1.1, 1.2], np.inf)))]
    distance = np.min([np.linalg.norm(points - points[k], axis=1) for k in chosen], axis=0)
    distance[~single] = 0.0
    while len(chosen) < MAX_POINTS and distance.max() > 0:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen
