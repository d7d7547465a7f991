"""The report in a real browser: it draws, answers clicks and keys, moves, complains of nothing and asks nobody."""

import shutil
from functools import cache

import numpy as np
import pytest

import contvines as cv
from contvines.graph.contents import Attractor
from contvines.loci.chart import Chart
from contvines.loci.locus import PlanePoint
from contvines.loci.regions import Region
from contvines.report.page import write_report
from contvines.survey import Survey, planned
from tests.machines import absorber_graph
from tools.pages.pages import page as machine_file

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


def chart():
    """A locus of symmetry breakings, a point and two regions."""
    graph = absorber_graph(0.7, (0.7, 0.75), depth=0)
    locus = cv.locus(graph["SB1"], over="friction", within=(0.4, 0.5))
    below = np.add.outer(np.arange(40), -np.arange(40)) < 0
    motions = [{"word": "LR", "periods": 1}]
    regions = [Region((0.71, 0.48), 0.5, motions, below), Region((0.74, 0.42), 0.5, [], ~below)]
    names = ("amplitude", "friction")
    cusp = PlanePoint("CP1", "cusp", names, (0.72, 0.45), (locus.label,), locus.branch.points[0])
    made = Chart(
        names, ((0.7, 0.75), (0.4, 0.5)), {locus.label: locus}, {"CP1": cusp}, regions, {"name": "absorber"}
    )
    made.finished = True
    return made


def atlas():
    graph = absorber_graph(0.55, (0.4, 0.6), depth=0)
    graph.attractors += [
        Attractor(0.5, "LR", 1, "periodic", "B1", 0.75, starts=16),
        Attractor(0.5, "", 0, "chaotic", None, 0.25, starts=16),
    ]
    return graph


def survey():
    """Closed-form outcomes over a grid of two with three samples, one of which failed."""
    plan = planned(
        {"half_width": [8.0, 10.0, 12.0], "mass": [1.0, 2.0], "friction": {"uniform": [0.1, 0.3]}}, samples=3
    )
    peak = np.array([s["half_width"] * s["mass"] + s["friction"] for s in plan.systems()])
    notes = np.array([*[""] * (len(peak) - 1), "it did not settle"], dtype=object)
    columns = {"peak": np.where(notes == "", peak, np.nan), "covered": np.where(notes == "", 1.0, np.nan)}
    columns = {name: column.reshape(plan.shape) for name, column in columns.items()}
    return Survey(plan, columns, notes.reshape(plan.shape), {"peak": "mm"}, {"over": "frequency"})


def declared():
    """A mass on a spring with a wall, in a machine file."""
    pytest.importorskip("heyoka")
    orbit = machine_file("impact_oscillator").attractor(frequency=2.3)
    return cv.diagram(orbit, over="frequency", within=(2.25, 2.35), depth=0)


RESULTS = {
    "graph": lambda: absorber_graph(0.55, (0.2, 0.9), depth=1),
    "chart": chart,
    "atlas": atlas,
    "survey": survey,
    "declared": declared,
}
EVERY = ["graph", "chart", "atlas", "survey"]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    return cache(lambda name: write_report(RESULTS[name](), folder / f"{name}.html", "x.vines"))


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as run:
        opened = run.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield opened
        opened.close()


@pytest.fixture
def opened(browser, written, request):
    address = written(getattr(request, "param", "graph")).as_uri()
    page = browser.new_page(viewport={"width": 1200, "height": 1300}, color_scheme="light")
    complaints, asked = [], []
    page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    page.wait_for_selector("body[data-ready=yes]", timeout=60_000)
    yield page
    assert complaints == []
    assert asked == [address]
    page.close()


def of(name):
    """The report on another result than the graph."""
    return pytest.mark.parametrize("opened", [name], indirect=True)


def text(page, place):
    return page.locator(place).inner_text()


def place_of(page, trace, i):
    """Where on the page a point of a trace is drawn."""
    return page.evaluate(
        """([k, i]) => { const d = document.getElementById("diagram"), f = d._fullLayout, t = d.data[k], r = d.getBoundingClientRect();
             return [r.left + f._size.l + f.xaxis.d2p(t.x[i]), r.top + f._size.t + f.yaxis.d2p(t.y[i])]; }""",
        [trace, i],
    )


def trace_with(page, what):
    return page.evaluate(f"() => document.getElementById('diagram').data.findIndex((t) => {what})")


def named_and_clicked(page, trace, i):
    """What hovering over a point of a trace says, before it is clicked."""
    x, y = place_of(page, trace, i)
    page.mouse.move(x, y)
    page.wait_for_selector("#diagram .hoverlayer .hovertext", timeout=60_000)
    said = page.locator("#diagram .hoverlayer").text_content()
    page.mouse.click(x, y)
    return said


def moves(page, attribute="data-frame"):
    """Play, until the picture has changed some times."""
    if text(page, "#play") == "play":
        page.locator("#play").click()
    for _ in range(4):
        before = page.locator("#animation").get_attribute(attribute)
        page.wait_for_function(
            f"document.getElementById('animation').getAttribute('{attribute}') !== '{before}'"
        )


def test_it_draws_and_a_click_on_a_row_jumps_to_the_point(opened):
    assert opened.locator("#diagram .scatterlayer .trace").count() > 3
    opened.locator("#row-LP1").click()
    assert text(opened, "#orbit-title") == "LP1: fold on B1"
    assert text(opened, "#command") == "contvines orbit x.vines LP1"
    assert text(opened, "#python") == 'cv.load("x.vines")["LP1"].orbit'
    assert "word LR" in text(opened, "#orbit-about")
    assert opened.locator("#portrait .scatterlayer .trace").count() == 3  # flights, jumps, events
    assert opened.locator("#history .scatterlayer .trace").count() == 4
    assert not opened.locator("#shares").is_visible()  # there are no attractors


def test_a_click_on_a_curve_shows_that_orbit_and_hovering_names_it(opened):
    middle, point = opened.evaluate(
        """() => { const t = document.getElementById("diagram").data[0], i = Math.floor(t.x.length / 2);
             return [i, t.customdata[i][1]]; }"""
    )
    assert "B1" in named_and_clicked(opened, 0, middle)
    opened.wait_for_function(f"document.getElementById('command').textContent.endsWith('B1:{point}')")


def test_the_absorber_moves_and_stops(opened):
    opened.locator("#row-SB1").click()
    moves(opened)
    opened.locator("#play").click()
    opened.wait_for_timeout(100)
    held = opened.locator("#animation").get_attribute("data-frame")
    opened.wait_for_timeout(200)
    assert opened.locator("#animation").get_attribute("data-frame") == held


@of("declared")
def test_the_body_of_a_machine_on_a_page_moves_before_its_wall(opened):
    opened.locator("#row-B1").click()
    assert opened.locator("#stage").is_visible()
    moves(opened, "data-body")
    assert "x of the machine" in opened.locator("#animation").get_attribute("aria-label")


def test_keys_walk_along_a_branch(opened):
    opened.locator("#row-B1").press("Enter")
    before = text(opened, "#command")
    opened.locator("#diagram").press("ArrowRight")
    assert before.startswith("contvines orbit x.vines") and text(opened, "#command") != before


def test_other_measures_can_be_chosen(opened):
    opened.locator("#y").select_option("impact_speed")
    opened.wait_for_function(
        "document.getElementById('diagram').layout.yaxis.title.text.startsWith('fastest impact')"
    )
    assert opened.locator("#y").input_value() == "impact_speed"
    assert opened.locator("#diagram .ytitle").text_content().startswith("fastest impact")


@of("chart")
def test_a_chart_shows_the_motion_of_the_point_that_is_clicked(opened):
    assert "1 locus, 1 point of codimension two, 2 regions" in text(opened, "#about")
    assert opened.locator("#portrait .scatterlayer .trace").count() == 3
    line = trace_with(opened, "t.customdata && t.customdata[0][1] !== null && t.x.length > 2")
    assert "symmetry breaking" in named_and_clicked(opened, line, 2)
    opened.wait_for_function("document.getElementById('python').textContent.endsWith('.orbit(2)')")
    assert "word LR" in text(opened, "#orbit-about")
    opened.locator("#row-CP1").click()
    assert text(opened, "#orbit-title") == "CP1: cusp"
    opened.locator("#row-SB1").press("Enter")
    before = text(opened, "#python")
    opened.locator("#diagram").press("ArrowRight")
    assert text(opened, "#python") != before
    moves(opened)
    assert opened.locator("#diagram .heatmaplayer image").count() == 1
    opened.locator("#tints").uncheck()
    opened.wait_for_function("document.querySelectorAll('#diagram .heatmaplayer image').length === 0")


@of("atlas")
def test_an_atlas_shows_shares_and_leads_from_an_attractor_to_its_branch(opened):
    assert opened.locator("#share .barlayer .trace").count() == 2
    rows = opened.locator("#attractors tbody tr")
    assert rows.count() == 2 and "75 % of 16" in rows.nth(0).inner_text()
    rows.nth(0).click()
    assert text(opened, "#orbit-title").startswith("B1, point")
    value = float(text(opened, "#orbit-about").split("amplitude = ")[1].split(";")[0])
    assert abs(value - 0.5) < 0.03


@of("survey")
def test_a_survey_shows_the_machines_behind_a_point(opened):
    assert "18 machines, 1 of them failed; uncertain: friction" in text(opened, "#about")
    assert opened.locator("#diagram .heatmaplayer image").count() == 1
    opened.locator("#over").select_option("half_width")
    opened.wait_for_function("document.querySelectorAll('#diagram .scatterlayer .trace').length > 4")
    k = trace_with(opened, "t.mode === 'markers' && t.x.length > 5")
    place = opened.evaluate(f"() => document.getElementById('diagram').data[{k}].customdata.indexOf(7)")
    opened.mouse.click(*place_of(opened, k, place))
    opened.wait_for_function("document.querySelector('#chosen tr.chosen')?.id === 'system-7'")
    assert text(opened, "#system-title") == "half_width = 10, mass = 1: 3 machines"
    opened.locator("#diagram").press("ArrowRight")
    opened.wait_for_function("document.querySelector('#chosen tr.chosen').id === 'system-8'")
    assert "it did not settle" in text(opened, "#failed")
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
