"""The command line on files that are there already, and on bad input: sentences, exit statuses, untouched files."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from contvines.command.cli import main
from contvines.store import Store, save
from tests.contvines import fakes

EXAMPLE = Path(__file__).parents[3] / "examples" / "friction.toml"


def test_help_lists_every_command(run):
    status, out, _ = run("--help")
    assert status == 0
    for name in ("diagram", "trace", "switch", "show", "orbit", "plot", "export", "sweep"):
        assert name in out
        assert run(name, "--help")[0] == 0


def test_the_package_runs_as_a_module():
    made = subprocess.run([sys.executable, "-m", "contvines", "--help"], capture_output=True, text=True)
    assert made.returncode == 0 and "Usage: contvines" in made.stdout


def test_help_and_version_import_nothing_heavy():
    code = (
        "import sys\nfrom contvines.command.cli import main\n"
        "try: main(['--help'])\nexcept SystemExit: pass\n"
        "print([m for m in ('numpy', 'scipy', 'matplotlib', 'networkx', 'pydantic') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_version(run):
    from contvines import __version__

    assert run("--version")[1].strip() == f"contvines {__version__}"


def test_show_prints_the_table_or_one_json_object(run, vines):
    status, out, err = run("show", vines)
    assert (status, err) == (0, "")
    for label in ("B1", "B2", "B3", "BP1", "VG1", "EP1"):
        assert label in out
    status, out, _ = run("show", vines, "--json")
    data = json.loads(out)
    assert status == 0
    assert data.pop("made")["contvines"]
    assert data == json.loads(json.dumps(fakes.pitchfork_graph().to_dict()).replace("Infinity", "null"))
    assert {
        "label",
        "kind",
        "branch",
        "value",
        "multipliers",
        "real",
        "criticality",
        "residual",
        "replay",
    } <= set(data["special"][0])


def test_switch_on_an_unfinished_file_is_refused_and_leaves_it_alone(run, tmp_path):
    for finished in (False, True):
        with Store.create(tmp_path / f"{finished}.vines", "f") as store:
            store.checkpoint(fakes.pitchfork_graph(finished=finished))
    before = (tmp_path / "False.vines").read_bytes()
    status, out, err = run("switch", "False.vines", "SB1")
    assert status != 0 and not out
    assert "False.vines" in err and "unfinished" in err and "again" in err
    assert (tmp_path / "False.vines").read_bytes() == before
    assert "unfinished" not in run("switch", "True.vines", "SB1")[2]


def test_show_on_an_unfinished_file_says_so(run, tmp_path):
    with Store.create(tmp_path / "u.vines", "f") as store:
        store.record("B1/0", {"x": 1.0})
    status, out, err = run("show", "u.vines")
    assert status == 0
    assert "unfinished" in err
    with Store.open(tmp_path / "u.vines", write=True) as store:
        store.checkpoint(fakes.pitchfork_graph(finished=False))
    status, out, err = run("show", "u.vines")
    assert (status, "B2" in out, "unfinished" in err) == (0, True, True)
    assert json.loads(run("show", "u.vines", "--json")[1])["finished"] is False


@pytest.mark.parametrize("kind", ["diagram", "multipliers", "network"])
def test_plot(run, vines, tmp_path, kind):
    status, out, err = run("plot", vines, "--kind", kind, "-o", "a.png")
    assert (status, out.strip(), err) == (0, "a.png", "")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("kind", ["csv", "json", "graphml", "mat"])
def test_export(run, vines, tmp_path, kind):
    status, out, _ = run("export", vines, "--to", kind)
    assert (status, out.strip()) == (0, f"g.{kind}")
    assert (tmp_path / f"g.{kind}").stat().st_size > 100


GOOD = EXAMPLE.read_text()
BAD_STUDIES = [
    ("restitution = 0.76", "restitution = 1.5", "restitution = 1.5"),
    ("within = [0.17, 1.27]", "within = [1.27, 0.17]", "reversed"),
    ("[model]", "[modle]", "did you mean 'model'"),
    ("[model]", "[model", "not valid TOML"),
    ('word = "LR"', 'word = ""', "stuck"),
]  # of all sentences there is a table in test_study
COMMANDS = ("diagram", "trace", "orbit", "sweep")
CASES = [(command, *case) for command in COMMANDS for case in BAD_STUDIES]
CASES.remove(("sweep", *BAD_STUDIES[-1]))  # it starts from rest: it needs no word


@pytest.mark.parametrize(("command", "old", "new", "sentence"), CASES)
def test_bad_studies_end_with_a_sentence_and_touch_nothing(run, tmp_path, command, old, new, sentence):
    assert old in GOOD
    (tmp_path / "bad.toml").write_text(GOOD.replace(old, new, 1))
    save(fakes.pitchfork_graph(), tmp_path / "other.vines")
    before = {p: p.read_bytes() for p in tmp_path.iterdir()}
    status, out, err = run(command, "bad.toml")
    assert status != 0
    assert err.startswith("contvines: bad.toml: ")
    assert sentence in err
    assert "Traceback" not in out + err
    assert {p: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("diagram", "none.toml"), "none.toml: there is no such file"),
        (("show", "none.vines"), "none.vines: there is no such file"),
        (("show", "notes.txt"), "notes.txt: this is not a .vines file; give one that `contvines diagram`"),
        (
            ("plot", "g.vines", "--kind", "pie"),
            "contvines: --kind pie: there is no such choice; choose one of d",
        ),
        (("diagram", EXAMPLE, "-o", "g.vines"), "g.vines: this file belongs to another study"),
        (("diagram", EXAMPLE.with_suffix(".tml")), "there is no such file (did you mean"),
        (("diagram", EXAMPLE, "-o", "none/g.vines"), "there is no folder 'none'"),
        (("diagram", EXAMPLE, "-o", "."), "this is a folder"),
        (("diagram", EXAMPLE, "--plot", "a.doc"), "must end in .png"),
        (("diagram", "g.vines"), "this is not a TOML file"),
        (("orbit", "g.vines"), "Give one of the labels BP1, EP1, VG1, B1, B2, B3"),
        (("orbit", "g.vines", "XX1"), "no label 'XX1'; it has B1, B2, B3, BP1, EP1, VG1"),
        (("orbit", "g.vines", "B1:41"), "numbered from 0 to 40"),
        (("orbit", EXAMPLE, "B1"), "a study has no labels"),
        (("plot", "g.vines", "-y", "speed"), "B1 has no measure 'speed'"),
        (("plot", "g.vines", "--kind", "multipliers", "--branch", "B9"), "B9: there is no such branch"),
        (("export", "g.vines", "-o", "points.xlsx"), "formats are csv, json, graphml, mat"),
        (
            ("export", "g.vines", "--to", "csv", "-o", "g.vines"),
            "g.vines: names in .vines are kept for graphs",
        ),
        (
            ("export", "g.vines", "--to", "mat", "-o", "notes.txt"),
            "notes.txt: this file exists and is no .mat",
        ),
        (("export", "g.vines", "--to", "csv", "-o", "d.csv"), "d.csv: this file is a database"),
        (("sweep", EXAMPLE, "-o", "keep.toml"), "use -o keep.csv"),
        (("switch", "g.vines", "B1"), "B1 is a branch"),
        (("sweep", EXAMPLE, "--over", "g.vines", "--plot", "a.png"), "g.vines continues in p"),
        (("shw", "g.vines"), "contvines: shw: there is no such command; did you mean show?"),
        (("show",), "contvines: FILE.vines is missing; `contvines show --help` says"),
        (("export", "g.vines"), "contvines: the format is missing: --to csv"),
        (("show", "g.vines", "--jsn"), "contvines: --jsn: there is no such option; did you mean --json?"),
        (("show", "g.vines", "x", "y"), "contvines: x y: this is too much for `contvines show`;"),
        (
            ("basins", EXAMPLE, "--at", "0.5", "--saddles", "--plot", "b.png"),
            "contvines: --saddles: its value is missing, --plot comes at once; see `contvines basins --help`",
        ),
        (
            ("diagram", EXAMPLE, "--quiet=3"),
            "contvines: --quiet: this option takes no value; write --quiet al",
        ),
        (
            ("diagram", EXAMPLE, "-y", "speed"),
            "contvines: -y speed: there is no such measure; choose one of amp",
        ),
        (
            ("trace", EXAMPLE, "-x", "impct_loss", "--plot", "a.png"),
            "-x impct_loss: there is no such measure (did you mean 'impact_loss'?)",
        ),
        (
            ("plot", "g.vines", "--branch", "B1"),
            "--branch B1: --kind diagram draws all branches and has no use",
        ),
        (("plot", "g.vines", "--kind", "multipliers", "-x", "p"), "-x p: --kind multipliers draws over"),
        (
            ("design", EXAMPLE, "--no-plot", "--plot", "a.png"),
            "--plot a.png and --no-plot exclude each other",
        ),
        (("export", "g.vines", "--to", "csv", "-o", "x.json"), "x.json: this is not a .csv file by its name"),
        (("diagram", EXAMPLE, "-o", "x.txt"), "x.txt: this is not a .vines file by its name; use -o x.vines"),
        (("diagram", EXAMPLE, "-o", "-"), "-: results are kept in files"),
    ],
)
def test_bad_requests_end_with_a_sentence_and_touch_nothing(run, vines, tmp_path, words, sentence):
    (tmp_path / "notes.txt").write_text("mine, not yours\n" * 20)
    (tmp_path / "keep.toml").write_text(GOOD)
    (tmp_path / "d.csv").write_bytes(vines.read_bytes())
    before = {p: p.read_bytes() for p in tmp_path.iterdir()}
    status, out, err = run(*words)
    assert status != 0
    assert sentence in err
    assert err.startswith("contvines: ") and err.count("\n") == 1  # one sentence
    assert "Traceback" not in out + err
    assert {p: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_debug_shows_the_traceback(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for words in (["--debug", "show", "none.vines"], ["show", "none.vines", "--debug"]):
        with pytest.raises(ValueError, match="there is no such file"):
            main(words)


def test_an_unexpected_error_is_a_sentence_too(run, monkeypatch, vines):
    import contvines.store

    def broken(*_, **__):
        raise TypeError("a bug")

    monkeypatch.setattr(contvines.store, "load", broken)
    status, _, err = run("show", vines)
    assert status == 1
    assert "something went wrong that should not (TypeError: a bug)" in err
    assert "--debug" in err
