"""A headless Chromium for pages that tests open, and the errors it reports."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

# software rendering: test machines have no graphics card, and root has no sandbox
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


def chromium() -> str:
    """The path of Chromium; skips the test where there is none."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None:
        pytest.skip("no Chromium to open the page with (Debian: apt-get install chromium; .ci/run does)")
    return found


@contextmanager
def opened(width: int = 1280, height: int = 900) -> Iterator[tuple[Any, list[str]]]:
    """(page, complaints): errors of the page and its console, and every request to another machine."""
    path = chromium()
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright drives the browser")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=OPTIONS)
        try:
            page = browser.new_page(viewport={"width": width, "height": height})
            # a busy machine without a graphics card takes up to a minute to draw a scene
            page.set_default_timeout(180_000)
            complaints: list[str] = []
            page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
            page.on("console", lambda m: complaints.append(f"console: {m.text}") if m.type == "error" else None)
            page.on(
                "request",
                lambda request: (
                    None
                    if request.url.startswith(("file:", "data:", "blob:"))
                    else complaints.append(f"request: {request.url}")
                ),
            )
            yield page, complaints
        finally:
            browser.close()
