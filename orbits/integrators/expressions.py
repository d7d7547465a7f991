"""Operations on symbolic formulas before integration: variables, derivatives, substitution, and generation of Python code."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.symbols import ELEMENTARY, Symbol, cos, cosh, log, sin, sinh

if TYPE_CHECKING:
    from types import ModuleType

NUMPY_NAMES = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}
SLOPES: dict[str, Callable[[Symbol, Symbol], Any]] = {  # derivative of f(x), from x and f
    "cos": lambda x, f: -sin(x),
    "sin": lambda x, f: cos(x),
    "tan": lambda x, f: 1.0 + f * f,
    "exp": lambda x, f: f,
    "log": lambda x, f: 1.0 / x,
    "sqrt": lambda x, f: 0.5 / f,
    "sinh": lambda x, f: cosh(x),
    "cosh": lambda x, f: sinh(x),
    "tanh": lambda x, f: 1.0 - f * f,
    "asin": lambda x, f: (1.0 - x * x) ** -0.5,
    "acos": lambda x, f: -((1.0 - x * x) ** -0.5),
    "atan": lambda x, f: 1.0 / (1.0 + x * x),
}


def variable(name: str) -> Symbol:
    """Return a symbol with a name."""
    return Symbol("variable", name)


def constant(value: float) -> Symbol:
    """Return a number as a symbol."""
    return Symbol("number", float(value))


def in_order(values: Sequence[Symbol]) -> list[Symbol]:
    """Return every expression contained in `values` once, after its operands."""
    done: dict[int, Symbol] = {}
    waiting = list(reversed(values))
    while waiting:
        node = waiting[-1]
        if id(node) in done:
            waiting.pop()
            continue
        left = [x for x in node.operands if isinstance(x, Symbol) and id(x) not in done]
        if left:
            waiting += left
        else:
            done[id(node)] = node
            waiting.pop()
    return list(done.values())


def variables_of(value: Symbol) -> set[str]:
    """Return the names of the variables in an expression."""
    return {node.operands[0] for node in in_order([value]) if node.operation == "variable"}


def derivatives(values: Sequence[Symbol], variables: Sequence[Symbol]) -> list[list[Symbol]]:
    """Return partial derivatives, ``[i][j]`` of value i by variable j."""
    order = in_order(values)
    columns = [_slopes(order, one) for one in variables]
    return [[column[id(value)] for column in columns] for value in values]


def _slopes(order: Sequence[Symbol], variable_node: Symbol) -> dict[int, Symbol]:
    zero = constant(0.0)
    slope: dict[int, Symbol] = {}
    for node in order:
        d: Symbol | float = zero
        if node is variable_node:
            d = constant(1.0)
        elif node.operation not in ("variable", "number"):
            parts = [slope[id(x)] for x in node.operands]
            if any(part is not zero for part in parts):
                d = _rule(node, parts)
        slope[id(node)] = d if isinstance(d, Symbol) else constant(d)
    return slope


def _rule(node: Symbol, d: Sequence[Symbol]) -> Symbol | float:
    """Return the derivative of an expression from those of its operands."""
    operation, operands = node.operation, node.operands
    if operation in SLOPES:
        return SLOPES[operation](operands[0], node) * d[0]
    a, b = operands
    if operation == "+":
        return d[0] + d[1]
    if operation == "-":
        return d[0] - d[1]
    if operation == "*":
        return d[0] * b + a * d[1]
    if operation == "/":
        return (d[0] - node * d[1]) / b
    through = b * a ** (b - 1.0) * d[0]
    return through if d[1].number == 0.0 else through + node * log(a) * d[1]


def replaced(value: Symbol, replacements: Mapping[str, float | Symbol]) -> Symbol:
    """Return the expression with numbers or other symbols in place of some variables."""
    places: dict[int, Symbol] = {}
    for node in in_order([value]):
        new = node
        if node.operation == "variable" and node.operands[0] in replacements:
            replacement = replacements[node.operands[0]]
            new = replacement if isinstance(replacement, Symbol) else constant(replacement)
        elif node.operation not in ("variable", "number"):
            new = rebuilt(node, [places[id(x)] for x in node.operands])
        places[id(node)] = new
    return places[id(value)]


OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "**": lambda a, b: a**b,
}


def rebuilt(node: Symbol, operands: Sequence[Any]) -> Symbol:
    """Return the same expression with other operands."""
    if node.operation in OPERATORS:
        return OPERATORS[node.operation](*operands)
    return Symbol(node.operation, *operands)


@dataclass(frozen=True)
class Layout:
    """Roles of the variables: states, independent variable, and numbers given at run time.

    Attributes
    ----------
    states : tuple of str
    clock : str
        The independent variable: the forcing phase, or time.
    numbers : tuple of str
        In the order of the vectors of numbers: parameters, then signs.
    """

    states: tuple[str, ...]
    clock: str
    numbers: tuple[str, ...]


def written(layout: Layout, values: Sequence[Symbol], tools: ModuleType) -> Callable:
    """Return a function ``f(x, clock, numbers)`` -> list of the values, as generated Python code.

    `tools` is the module with elementary functions, math or numpy. Every expression is one line of the code, so each is evaluated once.
    """
    names = {name: f"x[{i}]" for i, name in enumerate(layout.states)}
    names |= {layout.clock: "clock"} | {name: f"p[{i}]" for i, name in enumerate(layout.numbers)}
    text: dict[int, str] = {}
    lines = []
    for k, node in enumerate(in_order(values)):
        if node.operation == "number":
            text[id(node)] = f"({node.operands[0]!r})"
            continue
        if node.operation == "variable":
            source = names[node.operands[0]]
        elif node.operation in "+-*/":
            source = f" {node.operation} ".join(text[id(x)] for x in node.operands)
        else:
            function = "pow" if node.operation == "**" else node.operation
            source = f"{function}({', '.join(text[id(x)] for x in node.operands)})"
        text[id(node)] = f"t{k}"
        lines.append(f"    t{k} = {source}")
    body = "\n".join(
        ["def values(x, clock, p):", *lines, f"    return [{', '.join(text[id(v)] for v in values)}]"]
    )
    space: dict[str, Any] = {"nan": math.nan, "inf": math.inf, "pow": math.pow if tools is math else np.power}
    for name in ELEMENTARY:
        space[name] = getattr(tools, name if tools is math else NUMPY_NAMES.get(name, name))
    exec(compile(body, "<formulas of a declared machine>", "exec"), space)
    return space["values"]


class Values:
    """Functions of states, clock and numbers, at one point or many."""

    def __init__(self, layout: Layout, values: Sequence[Symbol]) -> None:
        self.layout, self.values, self.count = layout, tuple(values), len(values)
        self._one: Callable | None = None
        self._many: Callable | None = None

    def __call__(self, states: np.ndarray, clock: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Return values, shape (m, count), at `states` (m, n), `clock` (m,), `numbers` (m, P)."""
        if self._many is None:
            self._many = written(self.layout, self.values, np)
        out = np.empty((self.count, len(states)))
        with np.errstate(all="ignore"):
            for row, value in zip(out, self._many(states.T, clock, numbers.T)):
                row[:] = value
        return out.T

    def one(self, state: np.ndarray, clock: float, numbers: np.ndarray) -> np.ndarray:
        """Return values, shape (count,), at one point."""
        if self._one is None:
            self._one = written(self.layout, self.values, math)
        try:
            return np.array(self._one(state.tolist(), float(clock), numbers.tolist()))
        except (
            ArithmeticError,
            ValueError,
            TypeError,
        ):  # for example the root of a negative number: return NaN, as for many points
            return Values.__call__(self, state[None], np.array([clock]), numbers[None])[0]
