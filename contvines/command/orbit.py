"""`contvines orbit` and `prove`: show one orbit of a graph or the first orbit of a study; prove theorems about orbits, with certificates."""

from __future__ import annotations

import json as json_
import math
from pathlib import Path
from typing import Annotated, Any

import typer

from ..shared.numbers import complex_figures, figures
from ..shared.on_demand import needed
from ..text_table import fitted
from .frame import draw, held, interruptible, load_file, point_of, say, tell
from .options import JsonOption, PlotOption, TrustOption, argument, interval, option

# kind of measure that gives the unit of each number of an event
EVENTS = {
    "B_pre": "B_pre",
    "B_post": "B_post",
    "w": "max_abs_w",
    "w_rate": "B",
    "v": "max_abs_w",
    "v_rate": "B",
}
MANY = 2000  # number of boxes above which the check is announced, as it takes long


def orbit(
    file: Annotated[
        Path,
        argument("FILE.vines|STUDY.toml", "A result, or a study, whose first orbit is shown."),
    ],
    label: Annotated[
        str | None,
        argument("LABEL", "With FILE.vines: a special point (SB1), or a point of a branch (B1:12)."),
    ] = None,
    json: JsonOption = False,
    plot: PlotOption = None,
    animate: Annotated[
        Path | None,
        option("--animate FILE.gif", "Write an animation (gif, html; mp4 needs ffmpeg)."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """One orbit: its events, multipliers and margins."""
    from ..plots.portrait import plot_portrait

    if animate is not None:
        from ..shared.animations import check_animation

        check_animation(animate)

    found = _orbit(file, label, trust)
    data = _plain(found)
    text = str(found) if "equilibrium" in data else _describe(data)
    tell(fitted(text), data if json else None)
    draw(plot, lambda: plot_portrait(found))
    if animate is not None:
        animated = getattr(found, "animate", None)
        if not callable(animated):
            raise ValueError(f"--animate {animate}: this solution has no motion to show; --plot draws it")
        animated(animate)
        say(f"animation written to {animate}")


def _orbit(file: Path, label: str | None, trust: bool) -> object:
    from ..shared.files import is_database

    if not is_database(file) and file.suffix == ".toml":
        return _solution(*_first_orbit(file, label))
    from ..branches.special_point import SpecialPoint
    from ..graph import Graph
    from ..problems.registry import without_problem
    from ..store import load

    graph = load(file, trust=trust)
    if label is None:
        labels = (
            (*graph.special, *graph.branches) if isinstance(graph, Graph) else (*graph.points, *graph.loci)
        )
        raise ValueError(f"which orbit of {file}? Give one of the labels {', '.join(labels)}.")
    name = label.partition(":")[0]
    found, place = point_of(graph, label)
    if place is not None or hasattr(found, "__len__"):
        return found.orbit(place or 0)
    if isinstance(found, SpecialPoint) and isinstance(graph, Graph) and found.problem is None:
        raise ValueError(without_problem(name, graph.branches[found.branch].description))
    return found.orbit


def _first_orbit(file: Path, label: str | None) -> tuple[Any, tuple[float, float]]:
    """Return the first orbit of a study and the study's interval; raise a ValueError if a label is given."""
    from .compose import first_orbit
    from .study import read_study

    if label is not None:
        raise ValueError(f"{label}: a study has no labels yet; leave the label out, or give a .vines file.")
    study = read_study(file)
    return first_orbit(study), study.within


def _solution(start: object, within: tuple[float, float]) -> object:
    """Return the first solution of a study: its orbit, or the solution of its problem (equilibrium, cycle of a map)."""
    from ..problems.abilities import Started

    if not isinstance(start, Started):
        return start
    from ..continuation.engine import Engine
    from ..continuation.settings import Settings
    from ..continuation.starts import problem_and_start, solve_start

    problem, u, p = problem_and_start(start, None)
    first = solve_start(Engine(problem, within, Settings()), u, p)
    return problem.orbit(first.u, first.p)


def _plain(found: Any) -> dict[str, Any]:
    if hasattr(found, "to_dict"):
        return found.to_dict()
    return {n: getattr(found, n) for n in ("parameter", "value", "u", "points") if hasattr(found, n)}


def _describe(data: dict[str, Any]) -> str:
    """Describe an orbit as text, from the data that --json prints."""
    from ..graph.table import short_word, with_unit
    from ..shared.motions import marginal_text
    from ..text_table import Table, terminal_width

    lines, units, margins = [], data.get("units", {}), data.get("margins")
    pairs = data.get("multipliers", [])
    multipliers = [complex(*pair) for pair in pairs]
    stable = data.get("stable")
    stability = marginal_text(multipliers) if stable is None and pairs else "stable" if stable else "unstable"
    if "word" in data:
        nature = "real" if data["real"] else "virtual: no machine follows it"
        word = short_word(data["word"]) or data.get("rest", "stuck")
        lines.append(f"{word}  k = {data['periods']}  ({nature})")
    if "states" in data:  # a cycle of a flow
        lines.append(f"cycle of period {figures(data['period'])}  ({stability})")
    if parameters := data.get("parameters"):
        parameter_texts = (f"{k} = {v:.7g} {units.get(k, '')}".rstrip() for k, v in parameters.items())
        lines.append(f"  {'  '.join(parameter_texts)}")
    if nodes := data.get("nodes"):
        head = tuple(
            with_unit(name, None if name == "phase" else units.get(name) or units.get(EVENTS.get(name, "")))
            for name in nodes[0]
        )
        rows = [
            tuple(figures(x) if isinstance(x, float) else str(x) for x in node.values()) for node in nodes
        ]
        width = terminal_width()
        lines += [f"  {line}" for line in Table(head, rows, right=head).lines(width and width - 2)]
    if "multipliers" in data:
        text = complex_figures(multipliers)
        if any(math.isnan(part) for pair in pairs for part in pair):
            text = "not defined at a graze"
        elif text and "word" in data:
            text = f"{text}  ({stability})"
        lines.append(f"  multipliers: {text or 'none'}")
    if margins:
        smallest = min(margins, key=lambda m: m["value"])
        lines.append(
            f"  smallest margin: {figures(smallest['value'])} ({smallest['kind']}, segment {smallest['segment']}) "
            f"of {len(margins)}"
        )
    return "\n".join(lines or [f"{k}: {v}" for k, v in data.items()])


def prove(
    file: Annotated[
        Path,
        argument("FILE.vines|STUDY.toml", "A result, or a study, whose first orbit is proved."),
    ],
    labels: Annotated[
        list[str] | None,
        argument(
            "LABEL",
            "With FILE.vines: special points (PD1), orbits (B1:12), branches (B1); by default all special points.",
        ),
    ] = None,
    json: JsonOption = False,
    check: Annotated[
        bool,
        option("--check", "Check the certificates in the file with an independent program."),
    ] = False,
    bits: Annotated[
        int | None,
        option("--bits", "Precision in bits at the beginning; raised where that helps.", min=64, max=4096),
    ] = None,
    within: Annotated[
        tuple[str, str] | None,
        option("--within LOW HIGH", "With branches: only this interval of the parameter."),
    ] = None,
    output: Annotated[
        Path | None,
        option("-o, --output FILE.json", "Also write the certificates to a file."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Prove that orbits exist, are real or virtual, stable or unstable.

    Everything is computed in ball arithmetic, so each answer is a theorem
    about the machine with exactly these decimals as parameters, or says which
    step failed and what would help. Certificates are kept in FILE.vines;
    --check verifies them (or those of a certificate file) with nothing but
    the certificate and another arithmetic.
    """
    names = list(dict.fromkeys(labels or []))
    if check:
        _check(file, names, json)
        return
    if file.suffix == ".toml":
        proofs = _of_study(file, names, bits)
    else:
        with held(file, quiet=False):
            proofs = _of_file(file, names, bits, trust, within)
    if json:
        entries = {label: {"label": label, **proof.to_dict()} for label, proof in proofs.items()}
        single = len(names) == 1 or file.suffix == ".toml"
        typer.echo(json_.dumps(next(iter(entries.values())) if single else entries, indent=1))
    else:
        for label, proof in proofs.items():
            typer.echo(fitted(f"{label}: {proof}"))
    if output is not None:
        certificates = {label: proof.certificate() for label, proof in proofs.items() if proof.existence}
        output.write_text(json_.dumps(certificates, indent=1) + "\n", encoding="utf-8")


def _of_study(file: Path, labels: list[str], bits: int | None) -> dict[str, Any]:
    orbit, _ = _first_orbit(file, next(iter(labels), None))
    if not hasattr(orbit, "prove"):
        raise ValueError(
            f"{file}: its machine offers no proofs, for flights of declared machines have no closed form; machines of orbits that have one do"
        )
    return {"start": orbit.prove(bits=bits)}


def _of_file(
    file: Path, labels: list[str], bits: int | None, trust: bool, within: tuple[str, str] | None
) -> dict[str, Any]:
    from ..graph.proving import prove as prove_labels
    from ..graph.proving import subject
    from ..store import Store

    graph = load_file(file, trust)
    if not (labels or graph.special):
        raise ValueError(f"{file} has no special points to prove; give branches or orbits, B1 or B1:12.")
    if within is not None and not (labels and all(label in graph.branches for label in labels)):
        raise ValueError(
            f"--within {within[0]} {within[1]} is for branches; name them, {next(iter(graph.branches))} for one."
        )
    options = {} if within is None else {"within": interval("--within", within, graph.parameter, graph.units)}
    for label in labels:
        subject(graph, label)
    proofs: dict[str, Any] = {}
    note = f"what is proved is kept in {file}; name the labels that are missing to go on"
    with interruptible(note):
        for label in labels or list(graph.special):
            proofs |= prove_labels(graph, [label], bits=bits, **options)
            with Store.open(file, write=True) as store, store.transaction():
                store.put("proof", label, graph.proofs[label])
        with Store.open(file, write=True) as store:
            store.tidy()
    return proofs


def _certificates(file: Path, labels: list[str]) -> dict[str, Any]:
    """Return the certificates stored in a file, by label."""
    from ..shared.files import is_database
    from ..store import printable

    if is_database(file):
        proofs = load_file(file, problems=False).proofs
        found = {label: proof["certificate"] for label, proof in proofs.items()}
    else:
        try:
            found = json_.loads(file.read_text(encoding="utf-8"))
        except (ValueError, RecursionError):  # no JSON, huge numbers, or lists nested too deeply
            raise ValueError(f"{file}: this is neither a .vines file nor a file of certificates.") from None
        if isinstance(found, dict) and "format" in found:
            found = {"certificate": found}
        if not isinstance(found, dict):
            raise ValueError(f"{file}: this is no file of certificates.")
        found = printable(found)
    for label in labels:
        if label not in found:
            raise ValueError(
                f"{label}: {file} holds no proof of it; contvines prove {file} {label} makes one."
            )
    found = {label: found[label] for label in labels or found}
    if not found:
        raise ValueError(f"{file} holds no certificates; contvines prove {file} makes them.")
    return found


def _check(file: Path, labels: list[str], json: bool) -> None:
    needed("mpmath", "proofs")
    from orbits.proofs.checker import Refused
    from orbits.proofs.checker import check as verify

    verdicts: dict[str, dict[str, Any]] = {}
    for label, certificate in _certificates(file, labels).items():
        if (boxes := _boxes(certificate)) > MANY:
            typer.echo(f"{label}: {boxes} boxes to check, each takes milliseconds; Ctrl-C stops", err=True)
        try:
            if certificate is not None:
                verify(certificate)
                verdicts[label] = {"verified": True, "claims": _claims(certificate)}
            else:
                verdicts[label] = {"verified": None, "why": "nothing was proved"}
        except Refused as refusal:
            verdicts[label] = {"verified": False, "why": str(refusal)}
    if json:
        typer.echo(json_.dumps(verdicts, indent=1))
    else:
        for label, verdict in verdicts.items():
            result = "verified" if verdict["verified"] else f"NOT verified: {verdict['why']}"
            typer.echo(fitted(f"{label}: {result}"))
    if any(verdict["verified"] is False for verdict in verdicts.values()):
        raise typer.Exit(1)


def _boxes(certificate: object) -> int:
    """Return the number of boxes in a certificate, or in those of a branch's stretches; 0 if it is no certificate."""
    if isinstance(certificate, list):
        return sum(_boxes(one) for one in certificate if isinstance(one, dict))
    boxes = certificate.get("boxes") if isinstance(certificate, dict) else None
    return len(boxes) if isinstance(boxes, list) else 0


def _claims(certificate: object) -> object:
    """Return the claim of a certificate; for a branch the list of its stretches' claims."""
    if isinstance(certificate, list):
        return [_claims(one) for one in certificate]
    return certificate["claims"] if isinstance(certificate, dict) else None
