"""docs/design.md and its sequel: its study is the example, and its commands and snippet run as they stand, with a smaller study in its place."""

import inspect
import re
import shlex
import shutil
import tomllib
from pathlib import Path

import pytest

from contvines.command import recommending
from contvines.command.cli import main
from contvines.command.study import read_study
from contvines.command.survey_study import plan_and_machine

TOP = Path(__file__).parents[1]
PAGE = (TOP / "docs" / "design.md").read_text(encoding="utf-8")
STUDY = (TOP / "examples" / "design" / "machine.toml").read_text(encoding="utf-8")


def test_the_study_of_the_page_is_the_example():
    block = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0]
    assert tomllib.loads(block) == tomllib.loads(STUDY)


@pytest.mark.slow
@pytest.mark.long
def test_the_commands_and_the_snippet_of_the_page_run(tmp_path, monkeypatch, capsys):
    """What the command has found answers the snippet, too, which asks for the same."""
    recommend, found = recommending.recommend, []

    def asked_once(*asked, **options):
        inspect.signature(recommend).bind(*asked, **options)
        found.append(found[0] if found else recommend(*asked, **options))
        return found[0]

    monkeypatch.setattr(recommending, "recommend", asked_once)
    monkeypatch.chdir(tmp_path)
    place = tmp_path / "examples" / "design" / "machine.toml"
    place.parent.mkdir(parents=True)
    vary = 'samples = 1\nvary.half_width = { within = ["70 mm", "100 mm"], count = 5 }\n'
    small = STUDY.replace("[survey] ", "[survey]\n" + vary).replace("depth = 1", "depth = 0")
    place.write_text(small.replace('within = ["7 Hz", "9 Hz"]', 'within = ["7.8 Hz", "8.2 Hz"]'))
    lines = "".join(re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)).splitlines()
    lines = [shlex.split(line)[1:] for line in lines]
    assert [words[0] for words in lines] == ["diagram", "recommend", "report"]
    for words in lines:
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == 0, words
    for picture in ("response.png", "choice.png", "machine.html"):
        assert (tmp_path / picture).exists()
    names: dict = {}
    exec(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0], names)
    assert len(found) == 2 and names["found"] is found[0]
    assert 70.0 <= found[0].value <= 100.0 and found[0].loads["impulse"] > 0.0
    capsys.readouterr()


def test_the_studies_of_the_page_on_other_machines_are_read_and_ask_for_one_choice(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(TOP / "examples" / "machines" / "rubber_wall.py", tmp_path)
    text = (TOP / "docs" / "design_machines.md").read_text(encoding="utf-8")
    studies = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert len(studies) == 3
    for study in studies:
        (tmp_path / "study.toml").write_text(study)
        assert list(plan_and_machine(read_study(tmp_path / "study.toml"))[0].axes) == re.findall(
            r"vary.(\w+) = { within", study
        )
