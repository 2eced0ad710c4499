"""Rows of a bolt sheet: a quantity, the formula in words, its inputs, its limit and a verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

Verdict = Literal["ok", "exceeded", "not known", "value"]


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One number of a sheet.

    Args:
        symbol: Its symbol; rows find it by this.
        name: What it is, in words.
        unit: SI unit, "" for a plain number.
        value: In that unit; None where it is not known.
        missing: What would have to be given for it to be known; empty where it is.
    """

    symbol: str
    name: str
    unit: str
    value: float | None
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Step:
    """How a row is made: `function` of the values of `inputs`, in their order.

    Args:
        step: Step of the guideline, "R0" to "R13".
        symbol, name, unit: Of what comes out.
        formula: In words.
        inputs: Symbols of inputs and earlier rows.
        function: Gives the value in SI units.
        limit: Symbol of what the value must not exceed; "" where there is no limit.
        source: Of formula or limit.
    """

    step: str
    symbol: str
    name: str
    unit: str
    formula: str
    inputs: tuple[str, ...]
    function: Callable[..., float]
    limit: str = ""
    source: str


@dataclass(frozen=True, kw_only=True)
class Row:
    """One row of a sheet; see `Step`."""

    step: str
    result: Quantity
    formula: str
    inputs: tuple[Quantity, ...]
    limit: Quantity | None
    source: str

    @property
    def missing(self) -> tuple[str, ...]:
        """What would have to be given for the verdict to be known."""
        needs = self.result.missing + (self.limit.missing if self.limit is not None else ())
        return tuple(dict.fromkeys(needs))

    @property
    def utilisation(self) -> float | None:
        """Value over limit [-]; infinite where nothing is left of the limit, None where one of them is not known."""
        if self.limit is None or self.limit.value is None or self.result.value is None:
            return None
        if self.limit.value <= 0:
            return float("inf") if self.result.value > 0 else 0.0 if self.limit.value == 0 else float("inf")
        return self.result.value / self.limit.value

    @property
    def verdict(self) -> Verdict:
        """Whether the value exceeds its limit; "value" where there is no limit."""
        if self.missing:
            return "not known"
        used = self.utilisation
        if used is None:
            return "value"
        return "exceeded" if used > 1 else "ok"

    def to_dict(self) -> dict[str, Any]:
        """Return the row in SI units, for JSON; an infinite utilisation is None."""
        used = self.utilisation
        return {
            "step": self.step,
            "quantity": _plain(self.result),
            "formula": self.formula,
            "inputs": [_plain(one) for one in self.inputs],
            "limit": None if self.limit is None else _plain(self.limit),
            "utilisation": None if used is None or used == float("inf") else used,
            "verdict": self.verdict,
            "missing": list(self.missing),
            "source": self.source,
        }


def _plain(one: Quantity) -> dict[str, Any]:
    return {"symbol": one.symbol, "name": one.name, "unit": one.unit or "1", "values": one.value}


def evaluate(steps: Sequence[Step], known: Mapping[str, Quantity]) -> tuple[Row, ...]:
    """Return the rows of steps, each from `known` and the rows before it.

    A row that lacks an input is not known, and says what is missing; so are the rows that need it.
    """
    pool, rows = dict(known), []
    for step in steps:
        inputs = tuple(pool[symbol] for symbol in step.inputs)
        missing = tuple(dict.fromkeys(text for one in inputs for text in one.missing))
        value = None if missing else float(step.function(*(one.value for one in inputs)))
        result = Quantity(symbol=step.symbol, name=step.name, unit=step.unit, value=value, missing=missing)
        pool[step.symbol] = result
        limit = pool[step.limit] if step.limit else None
        rows.append(
            Row(step=step.step, result=result, formula=step.formula, inputs=inputs, limit=limit, source=step.source)
        )
    return tuple(rows)
