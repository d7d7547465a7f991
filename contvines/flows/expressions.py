"""Right-hand sides from SymPy expressions and from XPP's .ode files."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import CodeType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.shared.near_names import did_you_mean

if TYPE_CHECKING:
    from ..problems.functions import Parameters

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
TOKEN = re.compile(r"\d[\d.]*(?:e[+-]?\d+)?|([a-z_]\w*)")  # a number, or a name
ALLOWED = re.compile(r"^[\w\s.+\-*/(),]*$")
# keywords before name=value
DECLARED = re.compile(r"(par\w*|p|number|num|init|i)\s+(?=[a-z_]\w*\s*=)")
IGNORED = re.compile(r"(aux|set|only|export|options)\s+[^\s=]|[@\"]")
RANDOM = "random equations have no branches"
MEMORY = "equations that depend on the past are no ordinary differential equations"
JUMPS = "motions that jump are no smooth flow; orbits.Machine takes them"
ARRAYS = "arrays are not read; write a line for each state"
PIECES = "conditions and comparisons are not read; heav(x), sign(x), abs(x), max(x,y), min(x,y) are, and a sigmoid is smooth"
#: pattern of a line of XPP that is no ordinary differential equation -> the message for it
REFUSED = {
    r"wiener\s+[^\s=]": RANDOM,
    r"markov\s+[^\s=]": RANDOM,
    r"(.*\W)?(ran|normal|poisson)\(": RANDOM,
    r"volterra\s+[^\s=]": MEMORY,
    r"(.*\W)?(delay|del_shft|int)[({\[]": MEMORY,
    r"global\s+[^\s=]": JUMPS,
    r"table\s+[^\s=]": "tables are not read; write the function as a formula, or make the flow in Python (cv.FlowProblem)",
    r"special\s+[^\s=]": "sums over networks are not read; make the flow in Python (cv.FlowProblem)",
    r"(.*\W)?(sum|shift)\(": "sums over indices are not read; write them out",
    r"solv\s+[^\s=]|0\s*=": "equations that hold at all times are not read; solve them for their unknown by hand, or inside a function in Python",
    r"(bdry|b)\s+[^\s=]": "conditions at boundaries are not read: cycles and equilibria have none",
    r"\w+\(t\+1\)\s*=": "this is a map; cv.MapProblem takes it",
    r"#include\b": "other files are not included; copy their lines",
    r"%|.*\[": ARRAYS,
    r"(.*\W)?if\s*\(|.*([<>&|]|==|!=)": PIECES,
}
PARAMETER = re.compile(r"([A-Za-z_]\w*)\s*=\s*([^,\s]+)")


def name_of(symbol: object) -> str:
    """Return the name of a symbol, or of a state as a function of time (x(t) in SymPy's mechanics)."""
    from sympy.core.function import AppliedUndef

    return type(symbol).__name__ if isinstance(symbol, AppliedUndef) else str(symbol)


def compiled_expressions(
    expressions: Sequence[object], states: Sequence[object], parameters: Sequence[str], time: object = None
) -> tuple[Callable, Callable]:
    """Compile f and its Jacobian from SymPy expressions of states and parameters.

    Returns
    -------
    (callable, callable)
        (x, p) or (x, p, t) -> f, and df/dx, as nested lists; vectorised.

    Raises
    ------
    ValueError
        If an expression cannot be read, a symbol has no value, or a name is used twice.
    """
    import sympy

    if len(expressions) != len(states):
        raise ValueError(
            f"there are {len(expressions)} expressions for {len(states)} states; give one for each"
        )
    names = [*(name_of(s) for s in states), *parameters, *([] if time is None else [name_of(time)])]
    twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
    if twice is not None:
        raise ValueError(
            f"the name {twice!r} is there twice among states, params and time; choose another one"
        )
    # with real symbols the derivative of an absolute value is a sign
    plain = {s: sympy.Symbol(name_of(s), real=True) for s in (*states, *([] if time is None else [time]))}
    rates = sympy.Matrix([_expression(e) for e in expressions]).subs(plain)
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
    # the derivative of a step function is zero except at the step
    slopes = rates.jacobian(own[:d]).replace(sympy.DiracDelta, lambda *_: sympy.Integer(0))
    slope = sympy.lambdify(own, slopes.tolist(), modules="numpy")

    def arguments(x: np.ndarray, p: Parameters, t: tuple[object, ...]) -> list[object]:
        return [*(x[j] for j in range(d)), *(getattr(p, name) for name in parameters), *t]

    def f(x: np.ndarray, p: Parameters, *t: object) -> list[object]:
        return value(*arguments(x, p, t))

    def jacobian(x: np.ndarray, p: Parameters, *t: object) -> list[list[object]]:
        return slope(*arguments(x, p, t))

    return f, jacobian


def _expression(given: object) -> object:
    import sympy

    try:
        found = sympy.sympify(given)
    except (sympy.SympifyError, TypeError, AttributeError):
        found = None
    if not isinstance(found, sympy.Expr):
        raise ValueError(f"expressions: {given!r} is no expression of SymPy")
    return found


class Formula(NamedTuple):
    """The right-hand side of a line.

    Attributes
    ----------
    where : str
        The line, for messages.
    code : CodeType
        Compiled formula. All its names end with an underscore, so that Python's keywords may be names.
    names : set of str
        Quantities in the formula.
    calls : list of (str, int)
        Functions that it calls, with the numbers of arguments.
    """

    where: str
    code: CodeType
    names: set[str]
    calls: list[tuple[str, int]]


class Function(NamedTuple):
    """A function of the file."""

    arguments: list[str]
    body: Formula


def read_text(path: str | Path) -> tuple[Callable, list[str], list[float], dict[str, float], str]:
    """Read an .ode file: return f, the names of the states, their starts, the parameters, and a line that depends on time (or "").

    It reads ``x'=...`` and ``dx/dt=...``, ``par``, ``number``, ``init`` and ``x(0)=``, functions ``f(x,y)=...`` and fixed quantities
    ``name=...`` or ``!name=...``; a line that ends with ``\\`` continues in the next one. Lines that begin with ``aux``, ``set``, ``only``, ``export``,
    ``options``, ``@``, ``"`` or ``#`` are ignored, and so are all lines after ``done``.

    Raises
    ------
    ValueError
        If a line cannot be read; the message quotes it.
    """
    rates: dict[str, Formula] = {}
    starts: dict[str, float] = {}
    parameters: dict[str, float] = {}
    fixed: dict[str, Formula] = {}
    functions: dict[str, Function] = {}
    initial: dict[str, str] = {}  # states with initial values -> their lines, for messages

    def new(name: str, place: str) -> str:
        if name == "t" or callable(WORDS.get(name)):
            raise ValueError(
                f"{place}: the name {name!r} is that of {'the time' if name == 't' else 'a function'}; choose another one"
            )
        if any(name in table for table in (rates, parameters, fixed, functions)):
            raise ValueError(f"{place}: the name {name!r} is there twice; choose another one")
        return name

    for number, raw in _whole_lines(Path(path).read_text(encoding="utf-8", errors="replace")):
        include = raw.lower().startswith("#include")
        low = (raw if include else raw.split("#")[0]).strip().lower()
        if not low or IGNORED.match(low):
            continue
        if low == "done":
            break
        place = f"{path}, line {number}: {raw.strip()!r}"
        refused = next((reason for words, reason in REFUSED.items() if re.match(words, low)), "")
        if refused:
            raise ValueError(f"{place}: {refused}")
        if declared := DECLARED.match(low):
            for name, value in PARAMETER.findall(low[declared.end() :]):
                if declared[1].startswith("i"):
                    starts[name], initial[name] = _number(value, place), place
                else:
                    parameters[new(name, place)] = _number(value, place)
            continue
        if re.match(r"(par|number|init)\w*(\s|$)", low) and "=" not in low:
            raise ValueError(f"{place}: it has no name=value")
        if found := re.match(r"([a-z_]\w*)\s*'\s*=(.*)$|d([a-z_]\w*)/dt\s*=(.*)$", low):
            name, text = (found[1], found[2]) if found[1] else (found[3], found[4])
            rates[new(name, place)] = _formula(text, place)
        elif found := re.match(r"([a-z_]\w*)\(0\)\s*=(.*)$", low):
            starts[found[1]], initial[found[1]] = _number(found[2], place), place
        elif found := re.match(r"([a-z_]\w*)\(([^)]*)\)\s*=(.*)$", low):
            names = [part.strip() for part in found[2].split(",") if part.strip()]
            functions[new(found[1], place)] = Function(names, _formula(found[3], place))
        elif found := re.match(r"!?([a-z_]\w*)\s*=(.*)$", low):
            fixed[new(found[1], place)] = _formula(found[2], place)
        else:
            raise ValueError(
                f"{place}: only x'=..., dx/dt=..., par, init, functions and fixed quantities can be read"
            )
    if not rates:
        raise ValueError(f"{path}: it has no equation x'=... or dx/dt=...")
    for name, place in initial.items():
        if name not in rates:
            raise ValueError(
                f"{place}: {name!r} is no state{did_you_mean(name, rates)}; states are {', '.join(rates)}"
            )
    timed = _refuse_unknown(rates, parameters, fixed, functions)
    if not parameters:
        raise ValueError(f"{path}: it has no parameter; add a line such as par a=1")
    states = list(rates)
    f = _evaluator(rates, fixed, functions, list(parameters))
    return f, states, [starts.get(s, 0.0) for s in states], parameters, timed


def _whole_lines(text: str) -> Iterator[tuple[int, str]]:
    """Generate (number, line), with continued lines joined under the number of the first."""
    joined, number = "", 1
    for i, line in enumerate(text.splitlines(), start=1):
        number = number if joined else i
        joined += line.rstrip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        yield number, joined
        joined = ""
    if joined:
        yield number, joined


def _refuse_unknown(
    rates: Mapping[str, Formula],
    parameters: Mapping[str, float],
    fixed: Mapping[str, Formula],
    functions: Mapping[str, Function],
) -> str:
    """Raise an error for undefined names; return the first line that depends on time, or ""."""
    counts = {name: len(function.arguments) for name, function in functions.items()}
    words = {name for name, word in WORDS.items() if callable(word)}
    quantities = {*WORDS, *rates, *parameters, "t"} - words
    timed = ""
    lines: list[tuple[Formula, list[str]]] = [
        # a fixed quantity may use those of earlier lines
        *((formula, list(fixed)[:k]) for k, formula in enumerate(fixed.values())),
        *((function.body, [*fixed, *function.arguments]) for function in functions.values()),
        *((formula, list(fixed)) for formula in rates.values()),
    ]
    for formula, extra in lines:
        allowed = {*quantities, *extra}
        for name in sorted(formula.names - allowed):
            if name in fixed:
                raise ValueError(
                    f"{formula.where}: {name!r} is further down; a fixed quantity may only use those above it"
                )
            hint = did_you_mean(name, [*allowed, *functions, *words])
            raise ValueError(f"{formula.where}: {name!r} is no state, parameter or fixed quantity{hint}")
        for name, count in formula.calls:
            if name not in words and name not in counts:
                raise ValueError(
                    f"{formula.where}: {name!r} is no function{did_you_mean(name, [*functions, *words])}"
                )
            if counts.get(name, count) != count:
                raise ValueError(f"{formula.where}: {name} has {counts[name]} argument(s), not {count}")
        if "t" in formula.names and "t" not in extra:
            timed = timed or formula.where
    return timed


def _number(text: str, place: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{place}: {text.strip()!r} is no number") from None


def _formula(text: str, place: str) -> Formula:
    text = text.strip().replace("^", "**")
    if not ALLOWED.match(text) or "__" in text or re.search(r"[a-z_)]\s*\.", text):
        raise ValueError(f"{place}: only numbers, names, + - * / ^ ( ) and commas can be read")
    text = TOKEN.sub(lambda found: found[0] + "_" if found[1] else found[0], text)
    try:
        tree = ast.parse(text, mode="eval")
    except SyntaxError:
        raise ValueError(
            f"{place}: this is no formula: a formula has numbers and names with + - * / ^ ( ) between them"
        ) from None
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    called = {id(node.func) for node in calls}
    names = {node.id[:-1] for node in ast.walk(tree) if isinstance(node, ast.Name) and id(node) not in called}
    if any(isinstance(node, ast.Tuple) for node in ast.walk(tree)) or not all(
        isinstance(node.func, ast.Name) for node in calls
    ):
        raise ValueError(f"{place}: this is no formula: a comma or a bracket is at a wrong place")
    arguments = [(node.func.id[:-1], len(node.args)) for node in calls if isinstance(node.func, ast.Name)]
    return Formula(place, compile(tree, place, "eval"), names, arguments)


def _evaluator(
    rates: Mapping[str, Formula],
    fixed: Mapping[str, Formula],
    functions: Mapping[str, Function],
    parameters: Sequence[str],
) -> Callable:
    states = list(rates)

    def f(x: np.ndarray, p: Parameters, *t: object) -> list[object]:
        scope: dict[str, object] = {f"{name}_": word for name, word in WORDS.items()}
        scope |= {"__builtins__": {}, "t_": t[0] if t else 0.0}
        scope |= {f"{name}_": getattr(p, name) for name in parameters}
        scope |= {f"{name}_": x[j] for j, name in enumerate(states)}
        for name, (arguments, body) in functions.items():
            keys = [f"{argument}_" for argument in arguments]
            scope[f"{name}_"] = lambda *given, keys=keys, body=body: eval(
                body.code, {**scope, **dict(zip(keys, given, strict=True))}
            )
        for name, formula in fixed.items():
            scope[f"{name}_"] = eval(formula.code, scope)
        return [eval(formula.code, scope) for formula in rates.values()]

    return f
