"""A real Chromium, the one that is installed; none is downloaded."""

import shutil

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
WIDTHS = (1280, 390)


@pytest.fixture(scope="module")
def chromium(request):
    """A running browser. Skips where there is none, unless ``--require-browser``.

    For one file of tests: its event loop runs in this thread until it is closed, and no other
    can run beside it (a client of a Dask cluster has one).
    """
    missing = pytest.fail if request.config.getoption("--require-browser") else pytest.skip
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        missing("playwright is not installed: pip install playwright")
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        missing(f"no Chromium is installed, by none of the names {', '.join(NAMES)}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


class Visit:
    """A page that was opened from a file, with all that it asked for and complained about."""

    def __init__(self, page, path, width=1280, scheme="light"):
        self.page = page
        self.address = path.as_uri()
        self.requests, self.complaints, self.dialogs = [], [], []
        self._heard = {
            "request": lambda request: self.requests.append(request.url),
            "pageerror": lambda error: self.complaints.append(str(error)),
            "dialog": self._refuse,
            "console": self._listen,
        }
        for event, listener in self._heard.items():
            page.on(event, listener)
        page.set_viewport_size({"width": width, "height": 900})
        page.emulate_media(media="screen", color_scheme=scheme)
        page.goto(self.address)

    def _listen(self, message):
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def _refuse(self, dialog):
        self.dialogs.append(dialog.message)
        dialog.dismiss()

    @property
    def elsewhere(self):
        """Addresses asked for outside of the folder of the report."""
        folder = self.address.rpartition("/")[0].removesuffix("/cases") + "/"
        return [url for url in self.requests if not url.startswith(folder)]

    @property
    def overflow(self):
        """How many pixels the page is wider than its window."""
        return self.page.evaluate(
            "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )

    def column(self, number, table=0):
        """Texts of a column of a sortable table, from the top."""
        return self.page.evaluate(
            "([t, n]) => [...document.querySelectorAll('table.sortable')[t].tBodies[0].rows]"
            ".map(row => row.cells[n].textContent)",
            [table, number],
        )

    def head(self, number, table=0):
        """The head of a column of a sortable table."""
        return self.page.locator("table.sortable").nth(table).locator("thead th").nth(number)

    def leave(self):
        for event, listener in self._heard.items():
            self.page.remove_listener(event, listener)
        self.page.goto("about:blank")


@pytest.fixture(scope="module")
def idle_pages():
    """Pages that nobody visits: to turn one to a file takes a quarter of opening another."""
    return []


@pytest.fixture
def visit(chromium, idle_pages):
    """Open pages: ``visit(path, width=390, scheme="dark")``; they are left at the end."""
    visits = []

    def open_page(path, **how):
        page = idle_pages.pop() if idle_pages else chromium.new_page()
        visits.append(Visit(page, path, **how))
        return visits[-1]

    yield open_page
    for one in visits:
        one.leave()
        idle_pages.append(one.page)
