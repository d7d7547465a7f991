"""The command line on files that are there already, and on bad input: sentences, exit statuses, untouched files."""

import json
import shlex
import subprocess
import sys

import pytest

from contvines.command.cli import COMMANDS, main
from contvines.store import Store
from tests.contvines import fakes
from tests.contvines.studies import COUPLED, EXAMPLES, PAPER, SI, STOP, STOP_FILE, TWO
from tests.orbits.design import laboratory

FRICTION = (EXAMPLES / "friction.toml").read_text()


def test_help_lists_every_command(run):
    out = run.ok("--help")
    for name in COMMANDS:
        assert name in out
        run.ok(name, "--help")


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

    assert run.ok("--version").strip() == f"contvines {__version__}"


def test_show_prints_the_table_or_one_json_object(run, vines):
    out = run.ok("show g.vines")
    for label in ("B1", "B2", "B3", "BP1", "VG1", "EP1"):
        assert label in out
    data = run.json("show g.vines")
    assert data.pop("made")["contvines"]
    assert data == json.loads(json.dumps(fakes.pitchfork_graph().to_dict()).replace("Infinity", "null"))


def test_switch_on_an_unfinished_file_is_refused_and_leaves_it_alone(run, tmp_path):
    for finished in (False, True):
        with Store.create(tmp_path / f"{finished}.vines", "f") as store:
            store.checkpoint(fakes.pitchfork_graph(finished=finished))
    before = (tmp_path / "False.vines").read_bytes()
    status, out, err = run("switch False.vines SB1")
    assert status != 0 and not out
    assert "False.vines" in err and "unfinished" in err and "again" in err
    assert (tmp_path / "False.vines").read_bytes() == before
    assert "unfinished" not in run("switch True.vines SB1")[2]


def test_show_on_an_unfinished_file_says_so(run, tmp_path):
    with Store.create(tmp_path / "u.vines", "f") as store:
        store.record("B1/0", {"x": 1.0})
    status, out, err = run("show u.vines")
    assert not status and "unfinished" in err
    with Store.open(tmp_path / "u.vines", write=True) as store:
        store.checkpoint(fakes.pitchfork_graph(finished=False))
    status, out, err = run("show u.vines")
    assert not status and "B2" in out and "unfinished" in err
    assert run.json("show u.vines")["finished"] is False


@pytest.mark.parametrize("kind", ["diagram", "multipliers", "network"])
def test_plot(run, vines, tmp_path, kind):
    status, out, err = run("plot", vines, "--kind", kind, "-o", "a.png")
    assert (status, out.strip(), err) == (0, "a.png", "")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("kind", ["csv", "json", "graphml", "mat"])
def test_export(run, vines, tmp_path, kind):
    assert run.ok("export", vines, "--to", kind).strip() == f"g.{kind}"
    assert (tmp_path / f"g.{kind}").stat().st_size > 100


# Lines, and what is said of them. In the folder: studies of the absorber, of a panel in a laboratory and of a machine in a file, a
# graph that is there already, and files that are somebody's own
REQUESTS = {
    "diagram none.toml": "none.toml: there is no such file",
    "show none.vines": "none.vines: there is no such file",
    "show notes.txt": "notes.txt: this is not a .vines file; give one that `contvines diagram`",
    "plot g.vines --kind pie": "contvines: --kind pie: there is no such choice; choose one of d",
    "diagram friction.toml -o g.vines": "g.vines: this file belongs to another study",
    "diagram friction.tml": "there is no such file (did you mean",
    "diagram friction.toml -o none/g.vines": "there is no folder 'none'",
    "diagram friction.toml -o .": "this is a folder",
    "diagram .": "this is a folder; give the path of a TOML study",
    "diagram friction.toml --plot a.doc": "must end in .png",
    "diagram friction.toml --plot a": "must end in .png",
    "diagram friction.toml --plot none/a.png": "there is no folder",
    "diagram g.vines": "this is not a TOML file (it is no text in UTF-8). It is a database",
    "diagram stop.py": "this is a file of Python: run it with python",
    "orbit g.vines": "Give one of the labels BP1, EP1, VG1, B1, B2, B3",
    "orbit g.vines XX1": "no label 'XX1'; it has B1, B2, B3, BP1, EP1, VG1",
    "orbit g.vines B1:41": "numbered from 0 to 40",
    "orbit friction.toml B1": "a study has no labels",
    "plot g.vines -y speed": "B1 has no measure 'speed'",
    "plot g.vines --kind multipliers --branch B9": "B9: there is no such branch",
    "export g.vines -o points.xlsx": "formats are csv, json, graphml, mat",
    "export g.vines --to csv -o g.vines": "g.vines: names in .vines are kept for graphs",
    "export g.vines --to mat -o notes.txt": "notes.txt: this file exists and is no .mat",
    "export g.vines --to csv -o d.csv": "d.csv: this file is a database",
    "sweep friction.toml -o keep.toml": "use -o keep.csv",
    "switch g.vines B1": "B1 is a branch",
    "sweep friction.toml --over g.vines --plot a.png": "g.vines continues in p",
    "shw g.vines": "contvines: shw: there is no such command; did you mean show?",
    "show": "contvines: FILE.vines is missing; `contvines show --help` says",
    "export g.vines": "contvines: the format is missing: --to csv",
    "show g.vines --jsn": "contvines: --jsn: there is no such option; did you mean --json?",
    "show g.vines x y": "contvines: x y: this is too much for `contvines show`;",
    "basins friction.toml --at 0.5 --saddles --plot b.png": "contvines: --saddles: its value is missing, --plot comes at once; see `contvines basins --help`",
    "diagram friction.toml --quiet=3": "contvines: --quiet: this option takes no value; write --quiet al",
    "diagram friction.toml -y speed": "contvines: -y speed: there is no such measure; choose one of amp",
    "trace friction.toml -x impct_loss --plot a.png": "-x impct_loss: there is no such measure (did you mean 'impact_loss'?)",
    "plot g.vines --branch B1": "--branch B1: --kind diagram draws all branches and has no use",
    "plot g.vines --kind multipliers -x p": "-x p: --kind multipliers draws over",
    "design friction.toml --no-plot --plot a.png": "--plot a.png and --no-plot exclude each other",
    "export g.vines --to csv -o x.json": "x.json: this is not a .csv file by its name",
    "diagram friction.toml -o x.txt": "x.txt: this is not a .vines file by its name; use -o x.vines",
    "diagram friction.toml -o -": "-: results are kept in files",
    "rerun g.vines": "keeps no study to run again, as it was saved from Python (graph.save): the script that made it",
    "report g.vines -o a.png": "must end in .html",
    "report g.vines -o none/a.html": "there is no folder",
    "export d.csv --to xml": "there is no such choice; choose one of csv, json, graphml, mat",
    "new foo": "contvines: foo: there is no such choice; choose one of absorber, coupled, cavity, si, machine, flow.",
    "new flow": "flow.py: this file is there already",
    "prove g.vines XX": "no label",
    "prove g.vines B1:9999": "numbered from 0",
    "prove g.vines BP1:1": "single point",
    "prove g.vines BP1 --within 0.5 0.6": "for branches",
    "prove g.vines B1 --within 0.6 0.5": "give the lower value first",
    "prove stop.toml": "offers no proofs",
    "design stop.toml": "closed forms of the built-in absorbers",
    "transient friction.toml --release 1": "has no oscillator",
    "recommend panel.toml": "this is not a file of contvines recommend",
    "transient panel.toml": "none is given",
    "transient panel.toml --release '0 mm'": "give a number other than 0",
    "transient panel.toml --release 12": "has no unit",
    "transient panel.toml --release fast": "--release = 'fast' is not a number with a unit",
    "transient panel.toml --release '12 mm' --tail '1 s'": "this goes with --record",
    "calibrate panel.toml": "neither is given",
    "calibrate panel.toml --impacts no.csv": "cannot be read",
    "survey panel.toml --workers 0": "--workers 0: give a number 1 or above",
    "random panel.toml": "the section [random] is missing",
}  # fmt: skip

RECORD = "transient panel.toml --record data.csv"
HITS = "calibrate panel.toml --impacts data.csv"
# Lines, rows of data.csv, and what is said
DATA = [
    (RECORD + " --tail 1", "0,1 1,2", "has no unit"),
    (RECORD, "time[s],acceleration[mm] 0,1 1,2", "no unit of this acceleration; expected m/s^2"),
    (RECORD, "0,1 0,2", "do not grow at row 1"),
    (RECORD, "0,1 0.5,x", "row 2 holds '0.5, x', not 2 numbers"),
    (RECORD, "0 1", "row 1 has 1 column; 2 columns are needed"),
    (HITS, "0 1 x", "row 3 holds 'x', not 1 number"),
    (HITS, "time[kg] 0 1 2", "which is no unit of this time; expected s"),
    (HITS, "0 2 1", "the instants do not grow at number 3: sort them"),
    (HITS, "0 1", "too few impacts"),
    (HITS, "", "there is no row of numbers; give 1 column"),
    (HITS + " --unknown restitusion", "0 1 2", "no such parameter (did you mean 'restitution'?)"),
    (HITS + " --limits restitution=0.9,0.3", "0 1 2", "expected low < high"),
    (HITS + " --limits friction=0,1", "0 1 2", "friction is not estimated"),
    (HITS + " --confidence 95", "0 1 2", "give a number between 0 and 1"),
    (HITS + " --release 12", "0 1 2", "has no unit"),
    (HITS + " --release '12 kg'", "0 1 2", "--release is shown in mm"),
    (HITS + " --measure max_abs_q1", "0 1 2", "this goes with --sweep"),
    (HITS + " --release '12 mm'", "0 0.1 7 7.1 15", "the model follow these impacts"),
    ("calibrate stop.toml --impacts data.csv --release 1", "1 2 3", "a declared machine says where its motions begin"),
]  # fmt: skip


def still(shaken):
    return SI.replace('base_amplitude = "0.3 mm"', shaken)


NOTHING = still('base_amplitude = "0 mm"')
GROWING = NOTHING.replace('"frequency"\nwithin = ["7.5 Hz", "8200 mHz"]', '"base_amplitude"\nwithin = ["0 mm", "1 mm"]')  # fmt: skip
PSD = "[random]\npsd = [[2, 0.1], [20, 0.1]]\n"
# Lines, the study s.toml, and what is said
STUDIES = [
    ("diagram", NOTHING, "base_amplitude = 0 mm: nothing shakes the machine, whatever frequency is; for example base_amplitude = "),
    ("diagram", still("base_amplitude = 0"), "base_amplitude = 0 mm: nothing shakes the machine, whatever frequency is; for example base_amplitude = "),
    ("diagram", still('force_amplitude = "0 N"'), "force_amplitude = 0 N: nothing shakes the machine, whatever frequency is; for example force_amplitude = "),
    ("diagram", still('base_acceleration = "0 m/s^2"'), "base_acceleration = 0 m/s^2: nothing shakes the machine, whatever frequency is; for example base_acceleration = "),
    ("diagram", GROWING, "base_amplitude = 0 mm: nothing shakes the machine, so no motion with the word 'LR' lasts; for example base_amplitude = \"0.3 mm\""),
    ("survey", NOTHING + "[survey]\nvary.restitution = [0.5, 0.6]", "base_amplitude = 0 mm: nothing shakes"),
    *[(line, NOTHING, "base_amplitude = 0 mm: nothing shakes") for line in ("sweep", "atlas", "trace", "calibrate --impacts hits.csv")],
    ("diagram", PAPER + "bounds = { foo = [0, 1] }", "there is no measure 'foo'"),
    ("diagram", PAPER + "bounds = { B = [2.0, 1.0] }", "B = [2, 1] is no interval"),
    ("diagram", PAPER + "bounds = { B = [nan, 1.0] }", "is no interval"),
    ("diagram", PAPER + "bounds = { B = [7.0, 8.0] }", "is outside of its bounds"),
    ("design", COUPLED.replace("[start]", "slope = 0.1\n[start]"), "closed forms of level cavities"),
    ("random", SI + "[random]\npsd = [[2, 0.1]]", "rows [frequency, density]"),
    ("random", SI + "[random]\npsd = [[20, 0.1], [2, 0.1]]", "ascending"),
    ("random", SI + PSD + 'parameter = "friction"', "leave it out"),
    ("random", TWO + PSD, "name the parameter that is random"),
    ("random", TWO + PSD + 'parameter = "frequency"', "sets the clock"),
    ("random", TWO + PSD + 'parameter = "clearance_1"', "wall 'L1' depends on it"),
    ("random", TWO + PSD + 'parameter = "frequenc"', "did you mean 'frequency'"),
    ("recommend", SI + '[survey]\nvary = { half_width = ["60 mm", "80 mm"], friction = [0.1, 0.2] }', "half_width and friction on a grid: contvines recommend chooses one"),
    ("recommend", SI + "[survey]\nvary.half_width = { within = [60, 80], count = 3 }", "vary.half_width.within[0] = 60 has no unit"),
    ("recommend", TWO + '[survey]\nvary.clearance_1.within = ["6 mm", "0.03 m"]', "vary.clearance_1 without count is uncertain; for example vary.clearance_1 = { within = [6.0, 30.0], count"),
    *(
        (command, FRICTION.replace(old, new, 1), says)
        for old, new, says in (
            ("restitution = 0.76", "restitution = 1.5", "restitution = 1.5"),
            ("within = [0.17, 1.27]", "within = [1.27, 0.17]", "reversed"),
            ("[chart]", "[chrt]", "did you mean 'chart'"),
            ("[model]", "[model", "s.toml: this is not valid TOML"),
            ('word = "LR"', 'word = ""', "stuck"),
        )
        for command in ("diagram", "trace", "orbit", "sweep")
        if (command, says) != ("sweep", "stuck")  # it starts from rest: it needs no word
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "file", "text", "sentence"),
    [
        *((line, "notes.txt", "mine, not yours\n" * 20, says) for line, says in REQUESTS.items()),
        *((line, "data.csv", rows.replace(" ", "\n"), says) for line, rows, says in DATA),
        *((line.replace(" ", " s.toml ", 1) if " " in line else line + " s.toml", "s.toml", text, says) for line, text, says in STUDIES),
    ],
)  # fmt: skip
def test_bad_requests_end_with_a_sentence_and_touch_nothing(
    run, vines, monkeypatch, tmp_path, line, file, text, sentence
):
    files = {
        "friction.toml": FRICTION, "keep.toml": FRICTION, "panel.toml": laboratory.STUDY, "stop.toml": STOP, "stop.py": STOP_FILE,
        "flow.py": "mine", "panel-recommend.json": "{}", "hits.csv": "0\n70\n131\n190\n260\n", "notes.txt": "mine", file: text,
    }  # fmt: skip
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    (tmp_path / "d.csv").write_bytes(vines.read_bytes())
    before = {p: p.read_bytes() for p in tmp_path.iterdir()}
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # Python's own cache beside stop.py
    status, out, err = run(*shlex.split(line))
    assert status and sentence in err
    assert err.startswith("contvines: ") and err.count("\n") == 1  # one sentence
    assert "Traceback" not in out + err
    assert {p: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_debug_shows_the_traceback(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for line in ("--debug show none.vines", "show none.vines --debug"):
        with pytest.raises(ValueError, match="there is no such file"):
            main(line.split())


def test_an_unexpected_error_is_a_sentence_too(run, monkeypatch, vines):
    def broken(*_, **__):
        raise TypeError("a bug")

    monkeypatch.setattr("contvines.store.load", broken)
    status, _, err = run("show", vines)
    assert status == 1
    assert "something went wrong that should not (TypeError: a bug)" in err
    assert "--debug" in err
