"""`contvines prove`: theorems about orbits, special points and branches, with certificates."""

import json as json_
from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.amounts import interval
from contvines.command.frame import held, interruptible, load_file
from contvines.command.options import JsonOption, TrustOption, argument, option
from contvines.shared.on_demand import needed
from contvines.text_table import fitted

MANY = 2000  # boxes: checking more of them is announced


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
        about = {label: {"label": label, **proof.to_dict()} for label, proof in proofs.items()}
        alone = len(names) == 1 or file.suffix == ".toml"
        typer.echo(json_.dumps(next(iter(about.values())) if alone else about, indent=1))
    else:
        for label, proof in proofs.items():
            typer.echo(fitted(f"{label}: {proof}"))
    if output is not None:
        made = {label: proof.certificate() for label, proof in proofs.items() if proof.existence}
        output.write_text(json_.dumps(made, indent=1) + "\n", encoding="utf-8")


def _of_study(file: Path, labels: list[str], bits: int | None) -> dict[str, Any]:
    from contvines.command.compose import first_orbit
    from contvines.command.study import read_study

    if labels:
        raise ValueError(
            f"{labels[0]}: a study has no labels yet; leave the label out, or give a .vines file."
        )
    orbit = first_orbit(read_study(file))
    if not hasattr(orbit, "prove"):
        raise ValueError(
            f"{file}: its machine offers no proofs, for flights of declared machines have no closed form; machines of orbits that have one do"
        )
    return {"start": orbit.prove(bits=bits)}


def _of_file(
    file: Path, labels: list[str], bits: int | None, trust: bool, within: tuple[str, str] | None
) -> dict[str, Any]:
    from contvines.graph.proving import prove as prove_labels
    from contvines.graph.proving import subject
    from contvines.store import Store

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
    with Store.open(file, write=True) as store, interruptible(note):
        for label in labels or list(graph.special):
            proofs |= prove_labels(graph, [label], bits=bits, **options)
            with store.transaction():
                store.put("proof", label, graph.proofs[label])
        store.tidy()
    return proofs


def _certificates(file: Path, labels: list[str]) -> dict[str, Any]:
    """The certificates kept in a file, by label."""
    from contvines.file_names import is_database
    from contvines.store import printable

    if is_database(file):
        kept = load_file(file, problems=False).proofs
        found = {label: proof["certificate"] for label, proof in kept.items()}
    else:
        try:
            found = json_.loads(file.read_text(encoding="utf-8"))
        except (
            ValueError,
            RecursionError,
        ):  # text that is no JSON, numbers of thousands of digits, lists in lists without end
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
        if certificate is None:
            verdicts[label] = {"verified": None, "why": "nothing was proved"}
            continue
        if (boxes := _boxes(certificate)) > MANY:
            typer.echo(f"{label}: {boxes} boxes to check, each takes milliseconds; Ctrl-C stops", err=True)
        try:
            verify(certificate)
            verdicts[label] = {"verified": True, "claims": _claims(certificate)}
        except Refused as refusal:
            verdicts[label] = {"verified": False, "why": str(refusal)}
    if json:
        typer.echo(json_.dumps(verdicts, indent=1))
    else:
        for label, verdict in verdicts.items():
            typer.echo(
                fitted(f"{label}: {'verified' if verdict['verified'] else 'NOT verified: ' + verdict['why']}")
            )
    if any(verdict["verified"] is False for verdict in verdicts.values()):
        raise typer.Exit(1)


def _boxes(certificate: object) -> int:
    """How many boxes a certificate, or those of a branch's stretches, have; none if it is no certificate."""
    if isinstance(certificate, list):
        return sum(_boxes(one) for one in certificate if isinstance(one, dict))
    boxes = certificate.get("boxes") if isinstance(certificate, dict) else None
    return len(boxes) if isinstance(boxes, list) else 0


def _claims(certificate: object) -> object:
    """What a certificate claims; of a branch the claims of its stretches in turn."""
    if isinstance(certificate, list):
        return [_claims(one) for one in certificate]
    return certificate["claims"] if isinstance(certificate, dict) else None
