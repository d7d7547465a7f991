"""Studies: what is read, and the sentence for every value that cannot be used."""

import pytest

from contvines.command.cli import sentence
from contvines.command.study import StudyError, check_study, read_study
from contvines.command.survey_study import outcomes_of, plan_and_machine
from orbits.words import Word
from tests.contvines import studies
from tests.contvines.studies import COUPLED, EXAMPLES, PAPER, SI, STOP, STOP_FILE, TWO, WARM


def study(changes="", text=PAPER):
    return check_study(studies.data(text, changes))


def test_a_good_study_is_read_with_its_defaults():
    read = study("no continue.depth")
    assert read.name == "absorber"
    given = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}
    assert read.parameters == {"amplitude": 0.55, **given, "frequency": 1.0}
    start = {"word": "LR", "periods": 1, "guess": None}
    section = {"depth": 3, "virtual": False, "settings": {}, "parameter": "amplitude", "within": [0.2, 1.2]}
    assert read.describe().items() >= {"start": start, "continue": section}.items()


@pytest.mark.parametrize("start", ["no start", "no start\nstart.periods = 1"])
def test_a_study_without_a_word_begins_in_the_middle_of_its_interval(start):
    read = study(start)
    assert read.start.word is None
    assert read.parameters["amplitude"] == pytest.approx(0.7)


@pytest.mark.parametrize(("change", "excitation"), [("", 1.0), ('model.excitation = "truncated"', 0.0)])
def test_coupled_studies_have_their_own_parameters(change, excitation):
    read = study(change, COUPLED).parameters
    assert (read["damping"], read["frequency"], read["excitation"]) == (0.9, 0.98, excitation)


TWO_MASSES = (EXAMPLES / "structures" / "two_masses.toml").read_text()
NO_UNITS = """
from orbits import Machine
machine = Machine(name="bare", states=("x", "v"), parameters={"frequency": 1.0}, phase_rate="frequency",
    motion=lambda s, phase, p, c: (s.v, -s.x - s.v))
"""
SURVEYED = SI + "[survey]\nvary.restitution = [0.5, 0.6]\n"
SURVEYED_TWO = TWO + '[survey]\nvary.clearance_2 = ["8 mm", "10 mm"]\n'

# What is changed in a study, and what is said of it: parts of a sentence, "..." between them
REFUSED = {
    PAPER: {
        "model.restitution = 1.5": "[model] restitution = 1.5",
        "model.restitution = 0": "[model] restitution = 0",
        "model.friction = -0.5": "[model] friction = -0.5",
        "start.periods = 100_000": "[start] periods = 100000 ... whole number from 1 to 4096",
        'start.word = "LL"': "[start] ... LL",
        'start.word = "LxR"': "[start] ... x",
        "continue.within = [nan, 1.3]": "[continue] within[0] = nan ... not a finite number",
        "model.restitution = 0.0": "[model] restitution = 0.0 ... from 1e-6 to 1 ... 0.76",
        f'start.word = "{"LR" * 50_000}"': "[start] word has 100000 letters ... a word of events such as",
        'model.restitution = "high"': "[model] restitution = 'high' ... not a number",
        'model.gravity = "9.81 m/s^2"': "[model] gravity = '9.81 m/s^2' ... units = \"si\" ... first line",
        "no model.restitution": "[model] restitution is missing ... 0.76",
        "model.friction = nan": "[model] friction = nan ... not a finite number",
        "model.restituton = 0.7": "[model] restituton = 0.7 ... did you mean 'restitution'",
        "model.amplitude = 0.7": "[model] amplitude = 0.7 ... belongs to [start]",
        'model.name = "absorbr"': "[model] name = 'absorbr' ... did you mean 'absorber' ... 'coupled'",
        "no model.name": "[model] name is missing ... 'absorber'",
        "no model": "[model] is missing",
        "no continue\ncontnue.depth = 2": "[contnue]: there is no such section ... did you mean 'continue'",
        "atlas.starts = -1": "[atlas] starts = -1 ... from 1 to 10000000",
        "atlas.values = 0": "[atlas] values = 0 is out of range ... or a list of values",
        'chart = { parameter = "friction", within = [0.1, 0.5], depht = 2 }': "[chart] depht = 2 ... known are parameter, within",
        "start.periods = 0": "[start] periods = 0 ... whole number from 1 to 4096",
        "start.word = 3": "[start] word = 3 ... not text",
        "no start.amplitude": "[start] amplitude is missing ... from 0.2 to 1.2",
        "start.amplitude = 1.4": "[start] amplitude = 1.4 ... outside [continue] within = [0.2, 1.2]",
        "start.guess = [[1.0, 0.5], [2.0]]": "[start] guess[1] = [2.0] ... has 1 numbers ... [phase, B or w]",
        "start.guess = [[1.0, nan]]": "[start] guess[0][1] = nan ... not a finite number",
        'continue.parameter = "amplitud"': "parameter = 'amplitud' ... did you mean 'amplitude' ... restitution",
        "continue.within = [0.5, 0.5]": "[continue] within = [0.5, 0.5] is empty",
        "continue.within = [1.3, 0.2]": "[continue] within = [1.3, 0.2] is reversed ... give the lower end first",
        "continue.within = [0.2]": "[continue] within = [0.2] has 1 entries ... [low, high]",
        'continue = { parameter = "restitution", within = [0.5, 1.2] }': "leaves the range of restitution at 1.2 ... from 1e-6 to 1",
        "continue.depth = -1": "[continue] depth = -1 ... >= 0",
        "continue.depth = 2.0": "[continue] depth = 2.0 ... not a whole number",
        'continue.virtual = "yes"': "[continue] virtual = 'yes' ... true or false",
        "sweep.count = 1": "[sweep] count = 1 ... >= 2",
        "continue.bounds.B = 3": "bounds[B] = 3 cannot be used; expected two numbers for each measure",
    },
    COUPLED: {
        'model.excitation = "half"': "[model] excitation = 'half' is not a number; expected 'exact', 'truncated'",
        "start.amplitude = 0.55": "[start] amplitude = 0.55: there is no such field",
    },
    SURVEYED: {
        'model.unusual = "no"': "[model] unusual = 'no' is not true or false",
        'units = "imperial"': "units = 'imperial' is unknown; use \"si\"",
        'model.half_width = "20 m"': "[model] half_width = '20 m' is implausible",
        'model.half_width = "15 kg"': "[model] half_width = '15 kg': 'kg' is the unit of a mass",
        'model.stiffness = "9 kN/m"': "natural_frequency and stiffness say the same thing twice",
        'model.oscillator_mass = "3,8 kg"': "[model] oscillator_mass = '3,8 kg' is not a number with a unit (decimals stand behind a point)",
        'model.oscillator_mass = "-3.8 kg"': "[model] oscillator_mass = '-3.8 kg' is out of range; give a value above 0, for example \"3.8 kg\"",
        'model.natural_frequency = "8 kHz"': "frequency = 7.9 Hz is 0.000988 times natural_frequency = 8 kHz, which is implausible",
        'model.absorber_mass = "32 kg"': "absorber_mass = 32 kg is 8.42 times oscillator_mass = 3.8 kg, which is implausible",
        'start.word = "LtttR"': 'delete the line word = "LtttR" of [start]',
        'start.frequency = "9 Hz"': "[start] frequency = 9 Hz lies outside [continue] within = [7.5, 8.2] Hz",
        'continue.parameter = "speed"': "has no such quantity (did you mean 'frequency'?); it has",
        'continue = { parameter = "restitution", within = [0.5, 1.5] }': "[continue] within[1] = 1.5 is out of range; give a number above 0 and at most 1",
        'continue = { parameter = "slope", within = ["1 deg", "90.5 deg"] }': "[continue] within[1] = 90.5 deg is out of range; give a number from -90 to 90 deg",
        'survey.vary.half_width = ["15mm..25mm"]': "[survey] vary.half_width[0] = '15mm..25mm': 'mm..25mm' is no unit of a length",
        "survey.vary.half_width = { within = [8, 20], count = 2 }": "[survey] vary.half_width.within[0] = 8 has no unit",
        'survey.vary.half_width = "8 mm +- 1 mm"': "what is uncertain has uniform = [from, to]",
        "survey.vary = { restitution = { normal = [0.6, -0.1] } }": "[survey] vary.restitution.normal[1] = -0.1 is out of range",
        'survey.vary.absorber_mass = ["32 g", "32 kg"]': "vary.absorber_mass[1] = '32 kg': absorber_mass = 32000.0 g is 8.42 times oscillator_mass",
        'survey.vary.clearance = ["14 mm"]': "vary.clearance: the model 'coupled' has no such parameter (did you mean 'half_width'?)",
        'survey.outcomes = ["first:fould"]': "'first:fould': there are no points of this kind (did you mean 'fold'?)",
    },
    WARM: {
        "conditions.temperature = 90": "lies outside the table of restitution, which goes from 20 to 80",
        "no conditions.temperature\nconditions.temprature = 40": "which has no value (did you mean 'temprature'",
        "conditions.humidity = 1": "nothing depends on it",
        'conditions.temperature = "warm"': "is no finite number",
        "no conditions": "for example [conditions] temperature = 20",
        "model.restitution.temperature = [[20, 0.8], [10, 0.7], [80, 0.6]]": "ascending",
        "model.restitution.temperature = [[20, 0.8], [60], [80, 0.6]]": "a table over one condition",
        "conditions.temperature = 60\nmodel.restitution.temperature = [[20, 0.8], [60, 1.7], [80, 0.6]]": "restitution = 1.7",
        'continue = { parameter = "restitution", within = [0.5, 0.7] }': "depends on temperature",
        "survey.vary.temperature = [20, 90]": "lies outside the table",
        "survey.vary.restitution = [0.5, 0.6]": "depends on temperature; vary temperature",
    },
    TWO_MASSES: {
        "model.forces = [{ at = 3, amplitude = 0.1 }]": "[model] forces[0]: at = 3",
        "no model.mass": "mass is missing",
        "model.wall_gapp = 2.0": "wall_gap",
    },
    SURVEYED_TWO: {
        "start = -1": "start = -1 is not a section; write [start] on a line of its own",
        'model.clearance_1 = "15 kg"': "[model] clearance_1 = '15 kg': clearance_1 is shown in mm; for example",
        'model.clearance_1 = "-15 mm"': "[model] clearance_1 = -15 mm is out of range: walls 'L1' and 'R1' leave no room",
        'model.oscillator_mass = "0 kg"': "[model] oscillator_mass = 0 kg is out of range: the mass that moves with q_rate",
        'continue.within = ["7 Hz", "9 m"]': "[continue] within: frequency = '9 m': frequency is shown in Hz",
        'continue = { parameter = "friction_1", within = [-0.1, 0.5] }': "[continue] within = [-0.1, 0.5]: friction_1 = -0.1 is out of",
        'survey.vary.clearance_1.within = ["6 mm", "wide"]': "[survey] vary.clearance_1 = 'wide' is not a number with a unit",
        'survey.vary.clearance_2 = ["-8 mm"]': "[survey] vary.clearance_2: clearance_2 = -8 mm is out of range: walls 'L2' and 'R2'",
    },
    STOP: {
        'model.name = "stop.py"': 'names a file but no machine in it; for example "stop.py:machine"',
        'model.name = "stop.py:other"': "it has no machine 'other'; it declares machine",
        'model.name = "stop.py:cos"': "cos is a function; an orbits.Machine or a contvines.FlowProblem is expected",
        'model.name = "none.py:machine"': "there is no such file",
        'model.name = "../elsewhere/stop.py:machine"': "a study runs Python files of its own folder (or of folders in it) only",
        'model.name = "/elsewhere/stop.py:machine"': 'for example "stop.py"',
        "model.mass = 1.0": "[model] mass = 1.0: there is no such field; known are ",
        'model.damping = "much"': "[model] damping = 'much' is not a number",
        "model.restitution = 2.0": "the restitution of wall 'R' is above 0 and at most 1",
        "survey.vary.mass = [1.0]": "has no such parameter; it has forcing, frequency",
        'survey = { vary.forcing = [1.0], outcomes = ["dissipation"] }': "'dissipation' is known for the built-in machines (dissipation also by a declared machine with energy=)",
        'survey = { vary.forcing = [1.0], outcomes = ["../own.py:tall"] }': "a study runs Python files of its own folder",
        'survey = { vary.forcing = [1.0], outcomes = ["/own.py:tall"] }': "a study runs Python files of its own folder",
        'units = "imperial"': "units = 'imperial' is unknown; use \"si\"",
        'units = "si"\nno model.gap\nmodel.name = "bare.py:machine"': "the machine 'bare' gives no units",
    },
}  # fmt: skip


@pytest.mark.parametrize(("text", "changes"), [(text, line) for text in REFUSED for line in REFUSED[text]])
def test_a_bad_value_is_refused_by_name_with_the_expected_value(text, changes, tmp_path):
    (tmp_path / "stop.py").write_text(STOP_FILE)
    (tmp_path / "bare.py").write_text(NO_UNITS)
    with pytest.raises(ValueError) as caught:
        data = studies.data(text, changes)
        read = check_study(data, tmp_path / "study.toml")
        if "survey" in data:
            plan_and_machine(read)
            outcomes_of(read)
    message = str(caught.value)
    for part in REFUSED[text][changes].split(" ... "):
        assert part in message
    assert "things to mend" not in message


def test_all_bad_values_are_told_together():
    with pytest.raises(StudyError, match=r"(?s)^3 things to mend.*periods.*restitution.*friction"):
        study("model.restitution = 2.0\nmodel.friction = -1.0\nstart.periods = 0")


def test_fingerprint_depends_on_what_decides_the_result_alone(tmp_path):
    def fingerprint(text, *verb):
        (tmp_path / "study.toml").write_text(text)
        return read_study(tmp_path / "study.toml").fingerprint(*verb)

    plain = fingerprint(PAPER)
    assert fingerprint("# a comment\n" + PAPER.replace("0.76", "0.760") + "[sweep]\ncount = 10\n") == plain
    assert plain not in (fingerprint(PAPER, "trace"), fingerprint(PAPER.replace("0.76", "0.7600001")))
    assert fingerprint(WARM) != fingerprint(WARM.replace("temperature = 40", "temperature = 20"))
    assert fingerprint(COUPLED)[:6] == "b80bbd"  # that of version 0.1


# Lines of a file, and what is said of it
MANGLED = {
    "[model\nname = ": "x.toml: this is not valid TOML: ",
    "friction = 0,5": "friction = 0,5 (line 2): decimals are written with a point: write 0.5",
    "virtual = no": "virtual = no (line 2): write false",
    "word = LR  # the first orbit": 'word = LR (line 2): text stands in quotes: write "LR"',
    "friction =": "friction =  (line 2): the value is missing",
    "x = " + "[" * 100_000: "nested too deeply",
    "[" + ".".join(["a"] * 5_000) + "]": "nested too deeply",
    "x = " + "{a = " * 5_000 + "1" + "}" * 5_000: "nested too deeply",
    "\n".join(f"[[a{'.b' * (i % 50)}]]" for i in range(200)): "",
    "x" * 3_000_000 + " = 1": "too long for a study",
    "z" * 900_000 + " = 1": "zzz...",
    "\n".join(f"k{i} = {i}" for i in range(20_000)): "and 19",
}


@pytest.mark.parametrize("lines", MANGLED, ids=range(len(MANGLED)))
def test_text_that_is_no_study_gets_a_short_sentence(tmp_path, lines):
    path = tmp_path / "x.toml"
    path.write_text("[continue]\n" + lines)
    with pytest.raises(StudyError) as caught:
        read_study(path)
    assert MANGLED[lines] in str(caught.value) and len(str(caught.value)) < 6_000


def test_words_of_many_thousand_events_are_read_in_linear_time():
    """32768 letters: a quadratic step anywhere would take minutes and gigabytes."""
    for text in ("LR", "stt"):
        word = Word.parse(text * (32_768 // len(text)))
        assert word.canonical() == word.rotate(len(text)).canonical()


def test_a_sentence_is_cut_where_a_word_in_it_is_huge():
    assert len(sentence(ValueError("no orbit " + "LR" * 20_000 + " here"))) < 300


def test_files_of_windows_editors_are_read(tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(PAPER.replace("\n", "\r\n").encode("utf-8-sig"))
    assert read_study(path).parameters == study().parameters
    path.write_bytes(PAPER.encode("utf-16"))
    with pytest.raises(StudyError, match="Save it as UTF-8"):
        read_study(path)
