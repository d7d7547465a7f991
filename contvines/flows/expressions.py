"""Right-hand sides from SymPy expressions and from XPP's .ode files."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..problems.parameters import Parameters

WORDS = {
    "exp": np.exp,
    "log": np.log,
    "ln": np.log,
    "log10": np.log10,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
    "heav": lambda x: np.heaviside(np.real(x), 0.5),
    "sign": np.sign,
    "pi": np.pi,
}
NAME = re.compile(r"[A-Za-z_]\w*")
ALLOWED = re.compile(r"^[\w\s.+\-*/(),]*$")
DECLARED = re.compile(
    r"(par\w*|p|number|num|init|i)\s+(?=[a-z_]\w*\s*=)"
)  # words before name=value, no names themselves
PASSED = re.compile(r"(aux|set|only)\s|[@\"]")
PARAMETER = re.compile(r"([A-Za-z_]\w*)\s*=\s*([^,\s]+)")


def name_of(symbol: object) -> str:
    """Of a symbol, or of a function of time that stands for a state, as x(t) of SymPy's mechanics."""
    from sympy.core.function import AppliedUndef

    return type(symbol).__name__ if isinstance(symbol, AppliedUndef) else str(symbol)


def compiled_expressions(
    expressions: Sequence[object], states: Sequence[object], parameters: Sequence[str], time: object = None
) -> tuple[Callable, Callable]:
    """f and its Jacobian from SymPy expressions of states and parameters."""
    import sympy

    # real symbols: the derivative of an absolute value is a sign
    plain = {s: sympy.Symbol(name_of(s), real=True) for s in (*states, *([] if time is None else [time]))}
    rates = sympy.Matrix([sympy.sympify(e) for e in expressions]).subs(plain)
    rates = rates.subs({s: sympy.Symbol(str(s), real=True) for s in rates.free_symbols})
    own = [
        *(plain[s] for s in states),
        *(sympy.Symbol(name, real=True) for name in parameters),
        *([] if time is None else [plain[time]]),
    ]
    unknown = sorted(str(s) for s in rates.free_symbols - set(own))
    if unknown:
        raise ValueError(f"the expressions have {', '.join(unknown)}; give a value in params for each")
    d = len(states)
    value = sympy.lambdify(own, list(rates), modules="numpy")
    slope = sympy.lambdify(own, rates.jacobian(own[:d]).tolist(), modules="numpy")

    def arguments(x: np.ndarray, p: Parameters, t: tuple[object, ...]) -> list[object]:
        return [*(x[j] for j in range(d)), *(getattr(p, name) for name in parameters), *t]

    def f(x: np.ndarray, p: Parameters, *t: object) -> list[object]:
        return value(*arguments(x, p, t))

    def jacobian(x: np.ndarray, p: Parameters, *t: object) -> list[list[object]]:
        return slope(*arguments(x, p, t))

    return f, jacobian


def read_text(path: str | Path) -> tuple[Callable, list[str], list[float], dict[str, float]]:
    """f, the names of the states, their starts and the parameters from an .ode file.

    Read are ``x'=...`` and ``dx/dt=...``, ``par``, ``number``, ``init`` and ``x(0)=``, functions ``f(x,y)=...`` and fixed quantities
    ``name=...``; lines that begin with ``aux``, ``@``, ``#`` or ``done`` are passed over.

    Raises
    ------
    ValueError
        For what cannot be read; the sentence has the line.
    """
    rates: dict[str, str] = {}
    starts: dict[str, float] = {}
    parameters: dict[str, float] = {}
    fixed: list[tuple[str, str]] = []
    functions: list[tuple[str, list[str], str]] = []
    for number, raw in enumerate(Path(path).read_text(encoding="utf-8").splitlines(), start=1):
        line = raw.split("#")[0].strip()
        low = line.lower()
        if not line or PASSED.match(low):
            continue
        if low == "done":
            break
        where = f"{path}, line {number}: {raw.strip()!r}"
        if declared := DECLARED.match(low):
            target = starts if declared[1].startswith("i") else parameters
            for name, value in PARAMETER.findall(line[declared.end() :]):
                target[name.lower()] = _number(value, where)
            continue
        if re.match(r"(par|number|init)\w*(\s|$)", low) and "=" not in low:
            raise ValueError(f"{where}: no name=value is there")
        found = re.match(r"([a-z_]\w*)\s*'\s*=(.*)$|d([a-z_]\w*)/dt\s*=(.*)$", low)
        if found:
            name, text = (found[1], found[2]) if found[1] else (found[3], found[4])
            rates[name] = _checked(text, where)
            continue
        found = re.match(r"([a-z_]\w*)\(0\)\s*=(.*)$", low)
        if found:
            starts[found[1]] = _number(found[2], where)
            continue
        found = re.match(r"([a-z_]\w*)\(([^)]*)\)\s*=(.*)$", low)
        if found:
            names = [part.strip() for part in found[2].split(",")]
            functions.append((found[1], names, _checked(found[3], where)))
            continue
        found = re.match(r"([a-z_]\w*)\s*=(.*)$", low)
        if found:
            fixed.append((found[1], _checked(found[2], where)))
            continue
        raise ValueError(
            f"{where}: only x'=..., dx/dt=..., par, init, functions and fixed quantities can be read"
        )
    if not rates:
        raise ValueError(f"{path}: it has no equation x'=... or dx/dt=...")
    states = list(rates)
    known = {
        *WORDS,
        *states,
        *parameters,
        *(name for name, _ in fixed),
        *(name for name, _, _ in functions),
        "t",
    }
    for owner, text, own in [
        *((name, text, []) for name, text in [*rates.items(), *fixed]),
        *((name, text, names) for name, names, text in functions),
    ]:
        for name in NAME.findall(re.sub(r"\d[\d.]*e[+-]?\d+", "0", text)):
            if name not in known and name not in own:
                raise ValueError(
                    f"{path}: {owner} has {name!r}, which is no state, parameter, function or fixed quantity"
                )
    return (
        _evaluator(rates, fixed, functions, list(parameters)),
        states,
        [starts.get(s, 0.0) for s in states],
        parameters,
    )


def _number(text: str, where: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{where}: {text.strip()!r} is no number") from None


def _checked(text: str, where: str) -> str:
    text = text.strip().replace("^", "**")
    if not ALLOWED.match(text) or "__" in text or re.search(r"[a-z_)]\s*\.", text):
        raise ValueError(f"{where}: only numbers, names, + - * / ^ ( ) and commas can be read")
    return text


def _evaluator(
    rates: Mapping[str, str],
    fixed: Sequence[tuple[str, str]],
    functions: Sequence[tuple[str, list[str], str]],
    parameters: Sequence[str],
) -> Callable:
    codes = [compile(text, name, "eval") for name, text in rates.items()]
    quantities = [(name, compile(text, name, "eval")) for name, text in fixed]
    bodies = [(name, names, compile(text, name, "eval")) for name, names, text in functions]
    states = list(rates)

    def f(x: np.ndarray, p: Parameters, *t: object) -> list[object]:
        scope: dict[str, object] = {"__builtins__": {}, **WORDS, "t": t[0] if t else 0.0}
        scope.update({name: getattr(p, name) for name in parameters})
        scope.update({name: x[j] for j, name in enumerate(states)})
        for name, names, body in bodies:
            scope[name] = lambda *given, names=names, body=body: eval(
                body, {**scope, **dict(zip(names, given, strict=True))}
            )
        for name, code in quantities:
            scope[name] = eval(code, scope)
        return [eval(code, scope) for code in codes]

    return f
