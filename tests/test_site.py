"""The built site: links work, pictures have alternative texts, pages are light and load nothing from elsewhere.

``python docs/build.py`` builds it (a minute or more); ``SITE`` gives its folder, by default build/site.
"""

from __future__ import annotations

import os
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from integrable.scene.file import scene_names
from tests.browser import opened

ROOT = Path(__file__).parents[1]
SITE = Path(os.environ.get("SITE", ROOT / "build" / "site"))
MOST = 2_000_000  # the most bytes of a page with all that it loads, except animated pages

pytestmark = pytest.mark.skipif(not (SITE / "index.html").exists(), reason="no site: python docs/build.py makes one")


class Page(HTMLParser):
    """The links of a page, the files that it loads, and its text."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.ids: set[str] = set()
        self.silent: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.ids |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag in ("img", "script") and given.get("src"):
            self.loads.append(given["src"])
        if tag == "link" and given.get("rel") in ("stylesheet", "preload", "icon"):
            self.loads.append(given["href"])
        if tag == "img" and not (given.get("alt") or "").strip():
            self.silent.append(given.get("src", ""))


@cache
def page(path: Path) -> Page:
    return Page(path)


def pages() -> list[Path]:
    moving = SITE / "_static"
    return [path for path in sorted(SITE.rglob("*.html")) if moving not in path.parents]


def test_every_scene_has_its_page_with_a_picture():
    for name in scene_names():
        loads = page(SITE / "gallery" / f"{name}.html").loads
        assert any(load.endswith(f"/{name}.png") for load in loads), name


def test_the_start_of_a_motion_is_seen_in_its_picture():
    """The palette of a picture has few colours; the colour of the small dot is one of them."""
    image = pytest.importorskip("PIL.Image")
    loaded = next(load for load in page(SITE / "gallery" / "chaplygin.html").loads if load.endswith("/chaplygin.png"))
    with image.open(SITE / "gallery" / loaded) as picture:
        colours = picture.convert("RGB").getcolors(1 << 24)
    assert sum(count for count, (red, green, blue) in colours if red > 180 and 60 < green < 130 and blue < 60) > 20


def test_links_are_whole():
    broken = []
    for path in pages():
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                assert parts.scheme in ("https", "mailto"), link
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists() or target.is_dir():
                broken.append(f"{path.relative_to(SITE)}: {link}")
            elif parts.fragment and target.suffix == ".html" and unquote(parts.fragment) not in page(target).ids:
                broken.append(f"{path.relative_to(SITE)}: {link}: no such place")
    assert broken == []


def test_pictures_have_words():
    assert {str(path.relative_to(SITE)): page(path).silent for path in pages() if page(path).silent} == {}


def test_pages_are_light_and_load_nothing_from_elsewhere():
    for path in pages():
        size = path.stat().st_size
        for load in page(path).loads:
            parts = urlsplit(load)
            if parts.scheme == "data":
                continue
            assert not parts.scheme, f"{path}: {load}"
            assert not parts.netloc, f"{path}: {load}"
            size += (path.parent / unquote(parts.path)).stat().st_size
        assert size < MOST, f"{path.relative_to(SITE)}: {size} bytes"


SHOWN = [
    "index", "start/neither", "howto/own_ball", "gallery/index", "gallery/chaplygin", "measured/index", "flow", "fuzz",
    "rooms/integrable/moving_point", "reference/batch",
]  # fmt: skip
# elements cut off at the right edge that are in no scrollable box
CUT = """() => [...document.querySelectorAll('.bd-article *')]
    .filter(e => e.getBoundingClientRect().right > innerWidth + 1)
    .filter(e => !e.closest('table, pre, iframe, .formula, p:has(> img)'))
    .map(e => e.textContent.slice(0, 40))"""


def test_formulas_are_mathml():
    flow = (SITE / "flow.html").read_text(encoding="utf-8")
    assert flow.count("<math") >= 3
    assert "\\frac" not in flow
    assert not [load for load in page(SITE / "flow.html").loads if "mathjax" in load.lower()]


def test_the_landing_page_begins_with_a_ball_that_rolls():
    """Its data and script are a small part of the page and come before the text."""
    page_text = (SITE / "index.html").read_text(encoding="utf-8")
    start = page_text.index('<figure class="rolling">')
    ball = page_text[start : page_text.index("</figure>", start)]
    assert len(ball.encode()) < 200_000
    assert "http" not in ball
    assert start < page_text.index("rolls on a table")


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 390])
def test_the_ball_rolls_unless_motion_is_unwanted(width):
    shown = "() => document.querySelector('.rolling canvas').toDataURL()"

    def moves():
        before = browser.evaluate(shown)
        browser.wait_for_timeout(1000)
        return browser.evaluate(shown) != before

    with opened(width) as (browser, complaints):
        for unwanted in (False, True):
            browser.emulate_media(reduced_motion="reduce" if unwanted else "no-preference")
            browser.goto((SITE / "index.html").as_uri(), wait_until="load")
            browser.wait_for_timeout(500)
            assert moves() != unwanted
            browser.click(".rolling button")
            browser.wait_for_timeout(500)
            assert moves() == unwanted
        assert complaints == []


@pytest.mark.slow
def test_search_finds_guides_before_internals():
    """A guide that contains the word ranks above scenes, rooms and the reference."""
    titles = """() => [...document.querySelectorAll('#search-results li a, ul.search li > a')]
        .map(a => a.getAttribute('href'))"""
    with opened() as (browser, _):
        for word in ("install", "integrator"):
            browser.goto((SITE / "search.html").as_uri() + f"?q={word}")
            browser.wait_for_function("() => document.querySelectorAll('ul.search li a').length > 5")
            browser.wait_for_timeout(1500)
            found = browser.evaluate(titles)
            guides = [k for k, link in enumerate(found) if link.startswith(("start/", "howto/"))]
            inner = ("gallery/", "rooms/", "reference/")
            internals = [k for k, link in enumerate(found) if link.startswith(inner)]
            assert guides
            assert guides[0] < min(internals, default=len(found)), (word, found[:5])


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 390])
def test_pages_open_in_a_browser(width):
    """No console errors, no external requests, no page wider than the window, nothing cut off."""
    with opened(width) as (browser, complaints):
        for name in SHOWN:
            browser.goto((SITE / f"{name}.html").as_uri(), wait_until="load")
            assert browser.evaluate("document.documentElement.scrollWidth") <= width, name
            assert browser.evaluate(CUT) == [], name
        assert complaints == []


@pytest.mark.slow
def test_the_first_table_of_the_report_is_seen_whole():
    """On a wide window its last column, the ratio of run times, needs no scrolling."""
    with opened() as (browser, _):
        browser.goto((SITE / "measured" / "index.html").as_uri())
        hidden = (
            "(() => { const t = document.querySelector('.bd-article table'); return t.scrollWidth - t.clientWidth; })()"
        )
        assert browser.evaluate(hidden) <= 0


@pytest.mark.slow
def test_tables_are_sorted_by_a_click():
    """A click sorts by run time, shortest first; a second click puts the longest first."""
    column = """() => { const t = document.querySelector('.sortable table');
        const k = [...t.tHead.rows[0].cells].findIndex(c => c.textContent.trim() === 'run time');
        t.tHead.rows[0].cells[k].querySelector('button').click();
        return [...t.tBodies[0].rows].map(r => r.cells[k].textContent.trim()); }"""
    units = {"s": 1.0, "ms": 1e-3, "µs": 1e-6}
    with opened() as (browser, _):
        browser.goto((SITE / "measured" / "rows.html").as_uri())
        up, down = browser.evaluate(column), browser.evaluate(column)
    seconds = [[float(cell.split()[0]) * units[cell.split()[1]] for cell in cells] for cells in (up, down)]
    assert seconds[0] == sorted(seconds[0])
    assert seconds[1] == seconds[0][::-1] or sorted(seconds[1], reverse=True) == seconds[1]
    assert len(up) > 5


@pytest.mark.slow
def test_the_body_moves_in_the_gallery():
    with opened() as (browser, complaints):
        browser.goto((SITE / "_static" / "view" / "chaplygin.html").as_uri())
        browser.wait_for_function("() => window.drawFrame")
        before = browser.evaluate("() => document.getElementById('ball').data[1].x[0]")
        browser.evaluate("() => drawFrame(50)")
        assert browser.evaluate("() => document.getElementById('ball').data[1].x[0]") != before
        assert complaints == []
