"""A real browser for tests of pages: Debian's Chromium, driven by Playwright; no browser is downloaded."""

import shutil
import time
from contextlib import contextmanager

import pytest

ARGUMENTS = ("--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader")
WAIT = 120_000  # ms: a command is a process of its own, and the machine may be slow
# the software renderer says that reading pixels stalls it
HARMLESS = ("GPU stall due to ReadPixels",)


@pytest.fixture(scope="session")
def browser():
    """One Chromium for a run; skipped where there is none."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="the package playwright is not installed")
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("no chromium; on Debian: apt-get install chromium")
    with sync_api.sync_playwright() as started:
        found = started.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        yield found
        found.close()


@contextmanager
def opened(browser, address, *, width=1280, height=800, allowed=("file:", "data:", "blob:"), **context):
    """A page at an address; at the end no error stood in its console, and it asked for nothing beyond `allowed`."""
    made = browser.new_context(viewport={"width": width, "height": height}, **context)
    page = made.new_page()
    faults, foreign = [], []
    page.on("console", lambda m: faults.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda fault: faults.append(str(fault)))
    page.on("request", lambda r: None if r.url.startswith(tuple(allowed)) else foreign.append(r.url))
    page.set_default_timeout(WAIT)
    try:
        page.goto(str(address))
        yield page
        assert [text for text in faults if not any(known in text for known in HARMLESS)] == []
        assert foreign == []
    finally:
        made.close()


def until(page, expression):
    """Wait until an expression is true; unlike wait_for_function, also under a policy that forbids evaluation."""
    end = time.monotonic() + WAIT / 1e3
    while not page.evaluate(f"Boolean({expression})"):
        assert time.monotonic() < end, f"{expression} did not become true"
        page.wait_for_timeout(50)
