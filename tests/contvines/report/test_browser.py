"""The report in a real browser: it draws, answers clicks and keys, moves, complains of nothing and asks nobody."""

import shutil

import numpy as np
import pytest

import contvines as cv
from contvines.graph.contents import Attractor
from contvines.loci.chart import Chart
from contvines.loci.locus import PlanePoint
from contvines.loci.regions import Region
from contvines.report.page import write_report
from contvines.survey import Survey, planned
from tests.machines import ABSORBER

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")]


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    seed = ABSORBER.symmetric_orbit(0.55)
    graph = cv.diagram(seed, over="amplitude", within=(0.2, 0.9), depth=1)
    return write_report(graph, tmp_path_factory.mktemp("report") / "page.html", "x.vines")


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as run:
        opened = run.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def chart_file(tmp_path_factory):
    """A locus of symmetry breakings, a point and two regions."""
    seed = ABSORBER.symmetric_orbit(0.7)
    graph = cv.diagram(seed, over="amplitude", within=(0.7, 0.75), depth=0)
    locus = cv.locus(graph["SB1"], over="friction", within=(0.4, 0.5))
    below = np.add.outer(np.arange(40), -np.arange(40)) < 0
    regions = [
        Region((0.71, 0.48), 0.5, [{"word": "LR", "periods": 1}], below),
        Region((0.74, 0.42), 0.5, [], ~below),
    ]
    chart = Chart(
        ("amplitude", "friction"),
        ((0.7, 0.75), (0.4, 0.5)),
        {locus.label: locus},
        {},
        regions,
        {"name": "absorber"},
    )
    chart.points["CP1"] = PlanePoint(
        "CP1", "cusp", chart.parameters, (0.72, 0.45), (locus.label,), locus.branch.points[0]
    )
    chart.finished = True
    return write_report(chart, tmp_path_factory.mktemp("report") / "chart.html", "x-chart.vines")


@pytest.fixture(scope="module")
def atlas_file(tmp_path_factory, page_file):
    seed = ABSORBER.symmetric_orbit(0.55)
    graph = cv.diagram(seed, over="amplitude", within=(0.4, 0.6), depth=0)
    graph.attractors += [
        Attractor(0.5, "LR", 1, "periodic", "B1", 0.75, starts=16),
        Attractor(0.5, "", 0, "chaotic", None, 0.25, starts=16),
    ]
    return write_report(graph, tmp_path_factory.mktemp("report") / "atlas.html", "x-atlas.vines")


@pytest.fixture(scope="module")
def survey_file(tmp_path_factory):
    """Closed-form outcomes over a grid of two with three samples, one of which failed."""
    plan = planned(
        {"half_width": [8.0, 10.0, 12.0], "mass": [1.0, 2.0], "friction": {"uniform": [0.1, 0.3]}}, samples=3
    )
    systems = list(plan.systems())
    peak = np.array([s["half_width"] * s["mass"] + s["friction"] for s in systems])
    notes = np.array(["", *[""] * (len(systems) - 2), "it did not settle"], dtype=object)
    columns = {
        "peak": np.where(notes == "", peak, np.nan).reshape(plan.shape),
        "covered": np.where(notes == "", 1.0, np.nan).reshape(plan.shape),
    }
    survey = Survey(plan, columns, notes.reshape(plan.shape), {"peak": "mm"}, {"over": "frequency"})
    return write_report(survey, tmp_path_factory.mktemp("report") / "survey.html", "x-survey.nc")


@pytest.fixture(scope="module")
def declared_file(tmp_path_factory):
    """A mass on a spring with a wall, in a machine file."""
    pytest.importorskip("heyoka")
    from orbits import Machine, Wall
    from orbits.symbols import cos

    machine = Machine(
        name="stop",
        states=("x", "v"),
        parameters={"forcing": 1.0, "frequency": 2.3, "damping": 0.05, "gap": 0.1, "restitution": 0.8},
        phase_rate="frequency",
        motion=lambda s, phase, p, contact: (s.v, p.forcing * cos(phase) - 2 * p.damping * s.v - s.x),
        contacts=[
            Wall("R", gap=lambda s, phase, p: p.gap - s.x, push={"v": -1.0}, restitution="restitution")
        ],
    )
    graph = cv.diagram(machine.attractor(frequency=2.3), over="frequency", within=(2.25, 2.35), depth=0)
    return write_report(graph, tmp_path_factory.mktemp("report") / "declared.html", "x.vines")


@pytest.fixture
def opened(browser, request):
    page_file = request.getfixturevalue(getattr(request, "param", "page_file"))
    page = browser.new_page(viewport={"width": 1200, "height": 1300}, color_scheme="light")
    page.complaints, page.asked = [], []
    page.on("console", lambda m: page.complaints.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on("request", lambda request: page.asked.append(request.url))
    page.goto(page_file.as_uri())
    page.wait_for_selector("body[data-ready=yes]", timeout=60_000)
    yield page
    assert page.complaints == []
    assert page.asked == [page_file.as_uri()]
    page.close()


def test_it_draws_and_a_click_on_a_row_jumps_to_the_point(opened):
    assert opened.locator("#diagram .scatterlayer .trace").count() > 3
    opened.locator("#row-LP1").click()
    assert opened.locator("#orbit-title").inner_text() == "LP1: fold on B1"
    assert opened.locator("#command").inner_text() == "contvines orbit x.vines LP1"
    assert opened.locator("#python").inner_text() == 'cv.load("x.vines")["LP1"].orbit'
    assert "word LR" in opened.locator("#orbit-about").inner_text()
    assert opened.locator("#portrait .scatterlayer .trace").count() == 2
    assert opened.locator("#history .scatterlayer .trace").count() == 4


def test_a_click_on_a_curve_shows_that_orbit_and_hovering_names_it(opened):
    place = opened.evaluate(
        """() => { const d = document.getElementById("diagram"), f = d._fullLayout, t = d.data[0],
             i = Math.floor(t.x.length / 2), r = d.getBoundingClientRect();
           return [r.left + f._size.l + f.xaxis.d2p(t.x[i]), r.top + f._size.t + f.yaxis.d2p(t.y[i]), t.customdata[i][1]]; }"""
    )
    opened.mouse.move(place[0], place[1])
    opened.wait_for_selector("#diagram .hoverlayer .hovertext", timeout=60_000)
    assert "B1" in opened.locator("#diagram .hoverlayer").text_content()
    opened.mouse.click(place[0], place[1])
    opened.wait_for_function(f"document.getElementById('command').textContent.endsWith('B1:{place[2]}')")


def test_the_absorber_moves_and_stops(opened):
    def frame():
        return int(opened.locator("#animation").get_attribute("data-frame"))

    opened.locator("#row-SB1").click()
    if opened.locator("#play").inner_text() == "play":
        opened.locator("#play").click()
    first = frame()
    opened.wait_for_function(f"Number(document.getElementById('animation').dataset.frame) > {first + 3}")
    opened.locator("#play").click()
    opened.wait_for_timeout(100)
    held = frame()
    opened.wait_for_timeout(200)
    assert frame() == held


@pytest.mark.parametrize("opened", ["declared_file"], indirect=True)
def test_the_body_of_a_machine_on_a_page_moves_before_its_wall(opened):
    opened.locator("#row-B1").click()
    assert opened.locator("#stage").is_visible()
    if opened.locator("#play").inner_text() == "play":
        opened.locator("#play").click()
    first = opened.locator("#animation").get_attribute("data-body")
    opened.wait_for_function(f"document.getElementById('animation').dataset.body !== '{first}'")
    assert "x of the machine" in opened.locator("#animation").get_attribute("aria-label")


def test_keys_walk_along_a_branch(opened):
    opened.locator("#row-B1").press("Enter")
    before = opened.locator("#command").inner_text()
    opened.locator("#diagram").press("ArrowRight")
    after = opened.locator("#command").inner_text()
    assert before.startswith("contvines orbit x.vines") and after != before


def test_other_measures_can_be_chosen(opened):
    opened.locator("#y").select_option("impact_speed")
    opened.wait_for_function(
        "document.getElementById('diagram').layout.yaxis.title.text.startsWith('fastest impact')"
    )
    assert opened.locator("#y").input_value() == "impact_speed"
    assert opened.locator("#diagram .ytitle").text_content().startswith("fastest impact")


EVERY = ["page_file", "chart_file", "atlas_file", "survey_file"]


def place_of(page, trace, i):
    """Where on the page a point of a trace is drawn."""
    return page.evaluate(
        """([k, i]) => { const d = document.getElementById("diagram"), f = d._fullLayout, t = d.data[k], r = d.getBoundingClientRect();
             return [r.left + f._size.l + f.xaxis.d2p(t.x[i]), r.top + f._size.t + f.yaxis.d2p(t.y[i])]; }""",
        [trace, i],
    )


def trace_with(page, what):
    return page.evaluate(f"() => document.getElementById('diagram').data.findIndex((t) => {what})")


@pytest.mark.parametrize("opened", ["chart_file"], indirect=True)
def test_a_chart_shows_the_motion_of_the_point_that_is_clicked(opened):
    assert "1 locus, 1 point of codimension two, 2 regions" in opened.locator("#about").inner_text()
    assert opened.locator("#portrait .scatterlayer .trace").count() == 2
    line = trace_with(opened, "t.customdata && t.customdata[0][1] !== null && t.x.length > 2")
    x, y = place_of(opened, line, 2)
    opened.mouse.move(x, y)
    opened.wait_for_selector("#diagram .hoverlayer .hovertext", timeout=60_000)
    assert "symmetry breaking" in opened.locator("#diagram .hoverlayer").text_content()
    opened.mouse.click(x, y)
    opened.wait_for_function("document.getElementById('python').textContent.endsWith('.orbit(2)')")
    assert "word LR" in opened.locator("#orbit-about").inner_text()
    opened.locator("#row-CP1").click()
    assert opened.locator("#orbit-title").inner_text() == "CP1: cusp"
    opened.locator("#row-SB1").press("Enter")
    before = opened.locator("#python").inner_text()
    opened.locator("#diagram").press("ArrowRight")
    assert opened.locator("#python").inner_text() != before
    first = int(opened.locator("#animation").get_attribute("data-frame"))
    if opened.locator("#play").inner_text() == "play":
        opened.locator("#play").click()
    opened.wait_for_function(f"Number(document.getElementById('animation').dataset.frame) > {first + 3}")
    assert opened.locator("#diagram .heatmaplayer image").count() == 1
    opened.locator("#tints").uncheck()
    opened.wait_for_function("document.querySelectorAll('#diagram .heatmaplayer image').length === 0")


@pytest.mark.parametrize("opened", ["atlas_file"], indirect=True)
def test_an_atlas_shows_shares_and_leads_from_an_attractor_to_its_branch(opened):
    assert opened.locator("#share .barlayer .trace").count() == 2
    rows = opened.locator("#attractors tbody tr")
    assert rows.count() == 2 and "75 % of 16" in rows.nth(0).inner_text()
    rows.nth(0).click()
    assert opened.locator("#orbit-title").inner_text().startswith("B1, point")
    value = float(opened.locator("#orbit-about").inner_text().split("amplitude = ")[1].split(";")[0])
    assert abs(value - 0.5) < 0.03


def test_a_diagram_without_attractors_has_no_shares(opened):
    assert not opened.locator("#shares").is_visible()


@pytest.mark.parametrize("opened", ["survey_file"], indirect=True)
def test_a_survey_shows_the_machines_behind_a_point(opened):
    assert "18 machines, 1 of them failed; uncertain: friction" in opened.locator("#about").inner_text()
    assert opened.locator("#diagram .heatmaplayer image").count() == 1
    opened.locator("#over").select_option("half_width")
    opened.wait_for_function("document.querySelectorAll('#diagram .scatterlayer .trace').length > 4")
    k = trace_with(opened, "t.mode === 'markers' && t.x.length > 5")
    place = opened.evaluate(f"() => document.getElementById('diagram').data[{k}].customdata.indexOf(7)")
    opened.mouse.click(*place_of(opened, k, place))
    opened.wait_for_function("document.querySelector('#chosen tr.chosen')?.id === 'system-7'")
    assert opened.locator("#system-title").inner_text() == "half_width = 10, mass = 1: 3 machines"
    opened.locator("#diagram").press("ArrowRight")
    opened.wait_for_function("document.querySelector('#chosen tr.chosen').id === 'system-8'")
    assert "it did not settle" in opened.locator("#failed").inner_text()
    opened.locator("#outcome").select_option("covered")
    opened.wait_for_function(
        "document.getElementById('diagram').layout.yaxis.title.text.startsWith('share of the interval')"
    )


@pytest.mark.parametrize("opened", EVERY, indirect=True)
def test_in_the_dark_on_paper_and_on_a_narrow_screen(opened):
    def brightness():
        return opened.evaluate(
            "() => getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3).reduce((a, b) => a + +b, 0)"
        )

    assert brightness() > 700
    opened.emulate_media(color_scheme="dark")
    opened.wait_for_function(
        "document.getElementById('diagram').layout.font.color === getComputedStyle(document.body).color"
    )
    assert brightness() < 120
    opened.emulate_media(media="print", color_scheme="light")
    assert brightness() > 700
    assert not opened.locator(".controls").first.is_visible()
    assert len(opened.pdf()) > 10_000
    opened.evaluate("dispatchEvent(new Event('beforeprint'))")
    wide = "Math.max(...[...document.querySelectorAll('.js-plotly-plot .main-svg')].map((svg) => svg.getBoundingClientRect().width))"
    assert opened.evaluate(wide) <= 700  # pixels between the margins of a sheet of A4
    opened.evaluate("dispatchEvent(new Event('afterprint'))")
    opened.emulate_media(media="screen")
    opened.wait_for_function(f"{wide} > 800")
    opened.set_viewport_size({"width": 420, "height": 900})
    opened.wait_for_timeout(300)
    assert opened.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    right = opened.evaluate(
        """() => Math.max(...[...document.querySelectorAll("table:not(#chosen) td")].map((cell) => cell.getBoundingClientRect().right))"""
    )
    assert right <= 420


@pytest.mark.parametrize("name", EVERY)
def test_every_page_is_small_and_has_no_addresses(name, request):
    text = request.getfixturevalue(name).read_text(encoding="utf-8")
    assert len(text) < 5_000_000
    for part in text.split('<script id="plotly"')[0], text.split("</script>")[-2]:
        assert "http" not in part.replace("http-equiv", "")
