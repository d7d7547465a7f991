"""The report in a real browser: it draws, answers clicks and keys, moves, complains of nothing and asks nobody."""

import shutil

import pytest

import contvines as cv
from contvines.report.page import write_report
from orbits import Absorber

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

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    seed = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006).symmetric_orbit(0.55)
    graph = cv.diagram(seed, over="amplitude", within=(0.2, 0.9), depth=1)
    return write_report(graph, tmp_path_factory.mktemp("report") / "page.html", "x.vines")


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as run:
        opened = run.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield opened
        opened.close()


@pytest.fixture
def opened(browser, page_file):
    page = browser.new_page(viewport={"width": 1200, "height": 1300})
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
    opened.wait_for_selector("#diagram .hoverlayer .hovertext", timeout=10_000)
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
