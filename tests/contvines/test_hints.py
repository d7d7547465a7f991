"""What is nearly right is refused with a hint."""

import numpy as np
import pytest

import contvines as cv
import orbits


def line():
    return cv.AlgebraicProblem(lambda u, p: u - p, [0.0])


def test_a_misspelt_argument_has_a_hint():
    with pytest.raises(
        TypeError, match=r"diagram has no argument 'dept' \(did you mean 'depth'\?\); it has seed, over"
    ):
        cv.diagram(line(), within=(-1.0, 1.0), dept=3)
    with pytest.raises(TypeError, match=r"settings=\{'max_step': 0.01\} would do"):
        cv.diagram(line(), within=(-1.0, 1.0), max_step=0.01)
    with pytest.raises(TypeError, match=r"trace has no argument 'whithin' \(did you mean 'within'"):
        cv.trace(line(), whithin=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"switch has no argument 'deph'"):
        cv.switch(cv.diagram(line(), within=(-1.0, 1.0)), "EP1", deph=1)


def test_a_missing_argument_is_named_with_its_meaning():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"^chart needs within \(Its interval\)$"):
        cv.chart(graph, over="q")
    with pytest.raises(
        TypeError, match=r"^chart needs graph \(A diagram in the first .*\) and over \(Name of the"
    ):
        cv.chart()
    with pytest.raises(TypeError, match=r"^Absorber needs friction \(Coulomb coefficient\) and gravity"):
        orbits.Absorber(restitution=0.76)
    with pytest.raises(
        TypeError, match=r"^Absorber takes its parameters by name, as restitution=0.76, not 0.5 alone"
    ):
        orbits.Absorber(0.5)


def test_a_type_error_from_within_stays_what_it_is():
    with pytest.raises(TypeError, match="^the seed must be an orbit or a problem with u0 and p0, not int$"):
        cv.diagram(3)


def test_kinds_that_there_are_not():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    assert len(graph.of_kind("end")) == 2 and graph.of_kind("symmetry-breaking") == []
    with pytest.raises(ValueError, match=r"there is no kind 'SB' \(did you mean 'symmetry-breaking'\?\)"):
        graph.of_kind("SB")
    with pytest.raises(ValueError, match=r"there is no kind 'folds' \(did you mean 'fold'\?\)"):
        graph.of_kind("folds")


def test_points_that_there_are_not():
    branch = cv.diagram(line(), within=(-1.0, 1.0))["B1"]
    with pytest.raises(
        IndexError, match=rf"B1 has no point 1000; its {len(branch)} points are numbered from 0"
    ):
        branch.orbit(1000)
    assert np.array_equal(branch.orbit(-1).u, branch.points[-1])


def test_methods_have_hints_as_functions_have(tmp_path):
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"Graph.to_pandas has no argument 'measurs'; it takes none"):
        graph.to_pandas(measurs=["norm"])
    with pytest.raises(TypeError, match=r"Branch.to_xarray has no argument 'measures'"):
        graph["B1"].to_xarray(measures=["norm"])
    with pytest.raises(
        TypeError, match=r"Graph.load has no argument 'trsut' \(did you mean 'trust'\?\); it has path"
    ):
        cv.Graph.load(tmp_path / "line.vines", trsut=True)
    with pytest.raises(TypeError, match=r"load has no argument 'trsut' \(did you mean 'trust'\?\)"):
        cv.load(tmp_path / "line.vines", trsut=True)
    with pytest.raises(
        TypeError, match=r"this picture has no argument 'figsze' \(did you mean 'figsize'\?\)"
    ):
        graph["EP1"].plot(figsze=(3.0, 2.0))
    assert graph["EP1"].plot(figsize=(3.0, 2.0)).get_size_inches().tolist() == [3.0, 2.0]


def test_what_makes_a_thing_has_hints():
    with pytest.raises(
        TypeError, match=r"MapProblem has no argument 'paramter' \(did you mean 'parameter'\?\); it has f"
    ):
        cv.MapProblem(lambda x, mu: mu * x, [1.0], paramter="mu")
    with pytest.raises(TypeError, match=r"Settings has no argument 'max_stp' \(did you mean 'max_step'\?\)"):
        cv.Settings(max_stp=1.0)
    with pytest.raises(ValueError, match=r"settings: there is no 'max_stp' \(did you mean 'max_step'\?\)"):
        cv.diagram(line(), within=(-1.0, 1.0), settings={"max_stp": 0.1})


def test_misspelt_values_have_hints():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    with pytest.raises(
        ValueError, match=r"legend = 'insid' is unknown \(did you mean 'inside'\?\); choose of inside"
    ):
        graph.plot(legend="insid")
    with pytest.raises(ValueError, match=r"color = 'brnch' is unknown \(did you mean 'branch'\?\)"):
        graph.plot(color="brnch")
    with pytest.raises(ValueError, match=r"B1 has no measure 'nrm' \(did you mean 'norm'\?\)"):
        graph.plot(y="nrm")
    with pytest.raises(AttributeError, match=r"contvines has no 'daigram' \(did you mean 'diagram'\?\)"):
        cv.daigram  # noqa: B018


def test_other_functions_have_hints_too():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"atlas has no argument 'valus' \(did you mean 'values'\?\)"):
        cv.atlas(line(), valus=3)
    with pytest.raises(TypeError, match=r"plot_diagram has no argument 'colour' \(did you mean 'color'\?\)"):
        graph.plot(colour="word")
    with pytest.raises(TypeError, match=r"B1.orbit\(1.5\): give the number of a point, from 0"):
        graph["B1"].orbit(1.5)


def test_short_forms_are_one_line_and_tell_the_truth():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    assert repr(graph["EP1"]) == "SpecialPoint(EP1: end on B1 at p = -1)"
    for thing in (graph, graph["B1"], graph["EP1"]):
        assert "\n" not in repr(thing) and len(repr(thing)) < 140
        assert "<table" in thing._repr_html_()


def test_a_misspelt_parameter_of_a_machine_has_a_hint():
    from orbits import Absorber, Coupled

    with pytest.raises(TypeError, match=r"Absorber has no parameter 'frction' \(did you mean 'friction'\?\)"):
        Absorber(restitution=0.76, frction=0.5, gravity=0.211)
    with pytest.raises(TypeError, match=r"Coupled has no parameter 'forcng' \(did you mean 'forcing'\?\)"):
        Coupled(forcng=2.0)
    machine = Absorber(restitution=0.76, friction=0.5, gravity=0.211)
    hinted = (
        r"amplitde is no parameter of the model 'absorber' \(did you mean 'amplitude'\?\); it has amplitude"
    )
    with pytest.raises(ValueError, match=hinted):
        machine.orbit("LR", amplitde=0.5)
    with pytest.raises(ValueError, match=hinted):
        machine.simulate({"w": 0.1}, amplitde=0.5)
    with pytest.raises(
        TypeError, match=r"Absorber.symmetric_orbit has no argument 'amplitde' \(did you mean"
    ):
        machine.symmetric_orbit(amplitde=0.5)
    with pytest.raises(ValueError, match=r"priods is no parameter .* \(did you mean 'periods'\?\)"):
        machine.orbit("LR", priods=2, amplitude=0.5)
    with pytest.raises(
        ValueError, match=r"'frequecy' is unknown to the model 'absorber' \(did you mean 'frequency'\?\)"
    ):
        machine.symmetric_orbit(amplitude=0.55).problem("frequecy")
    with pytest.raises(
        ValueError, match="word = 1000 is no word: give the events of a period as text, such as 'LR'"
    ):
        machine.orbit(1000, amplitude=0.5)
    with pytest.raises(TypeError, match=r"portrait has no argument 'figsze' \(did you mean 'figsize'\?\)"):
        machine.symmetric_orbit(amplitude=0.55).plot(figsze=(3.0, 2.0))


def test_a_misspelt_argument_of_a_page_has_a_hint():
    import orbits

    with pytest.raises(
        TypeError, match=r"Machine has no argument 'state' \(did you mean 'states'\?\); it has name"
    ):
        orbits.Machine(name="stop", state=("x", "v"))
    with pytest.raises(
        TypeError, match=r"Wall has no argument 'restituton' \(did you mean 'restitution'\?\)"
    ):
        orbits.Wall("R", gap=None, push={"v": -1.0}, restituton=0.5)
    with pytest.raises(TypeError, match=r"DryFriction has no argument 'limt' \(did you mean 'limit'\?\)"):
        orbits.DryFriction("floor", velocity=None, limt="mu")
    with pytest.raises(AttributeError, match=r"orbits has no 'Absorbr' \(did you mean 'Absorber'\?\)"):
        orbits.Absorbr  # noqa: B018
