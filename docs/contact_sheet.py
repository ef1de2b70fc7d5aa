"""One picture of every kind of page, to be looked at before a release; `make docs` makes it.

`python docs/contact_sheet.py SITE` writes SITE/contact-sheet.png: each kind at a desk's and a telephone's width, on a
light and a dark screen. Beside the pages of SITE stand those that commands write, of results that the tests keep, and
the workspace over the logs of the examples, on shore and on board. Pages that are wider than a telephone are named. It
needs Chromium and playwright, and says so where one is missing.
"""

import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial import api
from seatrial.workspace import workspace_beside

if TYPE_CHECKING:
    from playwright.sync_api import Browser

KINDS = (
    "index", "install", "ten-minutes", "tutorials/one-ship", "tutorials/usv", "tune", "logs", "believe", "workspace",
    "explanation/intervals", "trial-file", "trial-keys", "findings", "command-line", "api", "api/seatrial.identify",
    "api/seatrial.Fit", "gallery/index", "gallery/gusts", "notebooks/first_fit", "numbers", "measured", "studies",
    "architecture", "demo/report",
)  # fmt: skip
"""One page of each kind, by its address in the site."""
WIDTHS = (1400, 390)  # px, of a desk and of a telephone
HEIGHTS = (900, 844)  # px, of the first screen
SHOWN = (420, 150)  # px, width of each on the sheet
RESULTS = Path(__file__).parents[1] / "tests" / "data" / "folder" / "earlier_results"
SETTLED_MS = 2000  # until a page that asks its server has drawn what it was sent; chosen


def main(site: Path) -> int:
    """Photograph the pages and lay them on one sheet; return 1 where a page is cut on a telephone."""
    try:
        from photograph_workspace import BROWSERS, OPTIONS
        from playwright.sync_api import sync_playwright
    except ImportError:
        print("no contact sheet: it needs pip install playwright")
        return 0
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        print("no contact sheet: it needs Chromium")
        return 0
    wide, cells = [], []
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright, ExitStack() as served:
        opened = playwright.chromium.launch(executable_path=browser, args=OPTIONS)
        live = served.enter_context(_live_pages(Path(name), opened))
        addresses = {**_addresses(site), **_written_pages(Path(name)), **live}
        for scheme in ("light", "dark"):
            for width, height, shown in zip(WIDTHS, HEIGHTS, SHOWN, strict=True):
                page = opened.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
                for kind, address in addresses.items():
                    page.goto(address, wait_until="load")
                    if not address.startswith("file:"):
                        page.wait_for_timeout(SETTLED_MS)
                    picture = Path(name) / f"{kind.replace('/', '-')}-{width}-{scheme}.png"
                    page.screenshot(path=picture)
                    cells.append((kind, scheme, width, picture, shown))
                    if page.evaluate("document.documentElement.scrollWidth") > width:
                        wide.append(f"{kind} at {width} px")
                page.close()
        sheet = opened.new_page(viewport={"width": 2 * sum(SHOWN) + 60, "height": 900})
        paper = Path(name) / "sheet.html"
        paper.write_text(_sheet(cells), encoding="utf-8")
        sheet.goto(paper.as_uri(), wait_until="load")
        sheet.screenshot(path=site / "contact-sheet.png", full_page=True)
        opened.close()
    print(f"one picture of every kind of page: {site / 'contact-sheet.png'}")
    for text in sorted(set(wide)):
        print(f"wider than its window: {text}")
    return int(bool(wide))


def _addresses(site: Path) -> dict[str, str]:
    """Return the address of each kind that the site has."""
    paths = {kind: (site / f"{kind}.html").resolve() for kind in KINDS}
    return {kind: path.as_uri() for kind, path in paths.items() if path.exists()}


def _written_pages(folder: Path) -> dict[str, str]:
    """Write the page of each kind of result, and the poster of the fit, and return their addresses."""
    pages = {path.name: api.report(path, folder / f"{path.name}.html") for path in sorted(RESULTS.iterdir())}
    pages["poster"] = api.write_poster(api.poster(api.load_fit(RESULTS / "fit")), folder / "poster.html")
    return {kind: path.as_uri() for kind, path in pages.items()}


@contextmanager
def _live_pages(folder: Path, opened: "Browser") -> Iterator[Mapping[str, str]]:
    """Serve the workspace of a ship and of a craft whose log is followed, and yield their addresses."""
    from photograph_workspace import follow_log, followed_craft, ship_of_examples

    with (
        workspace_beside(ship_of_examples(folder)) as (_, ashore),
        workspace_beside(followed_craft(folder)) as (_, on_board),
    ):
        window = opened.new_page()
        window.goto(on_board)
        follow_log(window)
        window.close()
        yield {"workspace: logs": ashore, "workspace: on board": f"{on_board}#onboard"}


def _sheet(cells: list[tuple[str, str, int, Path, int]]) -> str:
    """Return the page with a row for each kind: light at both widths, then dark."""
    rows = []
    for kind in dict.fromkeys(cell[0] for cell in cells):
        pictures = "".join(
            f'<img src="{path.as_uri()}" width="{shown}">' for name, _, _, path, shown in cells if name == kind
        )
        rows.append(f"<h2>{kind}</h2><div>{pictures}</div>")
    style = "body{font:14px sans-serif;margin:8px}h2{font-size:14px;margin:8px 0 2px}div{display:flex;gap:8px}"
    return f"<style>{style}img{{align-self:start;border:1px solid #999}}</style>{''.join(rows)}"


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
