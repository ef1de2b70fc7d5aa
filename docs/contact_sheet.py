"""One picture of every kind of page, to be looked at before a release; `make docs` makes it.

`python docs/contact_sheet.py SITE` writes SITE/contact-sheet.png: each kind at a desk's and a telephone's width, on a
light and a dark screen. Pages that are wider than a telephone are named. It needs Chromium and playwright, and says so
where one is missing.
"""

import shutil
import sys
import tempfile
from pathlib import Path

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
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]


def main(site: Path) -> int:
    """Photograph the pages and lay them on one sheet; return 1 where a page is cut on a telephone."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        browser = None
    if browser is None:
        print("no contact sheet: it needs Chromium, and pip install playwright")
        return 0
    wide, cells = [], []
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=browser, args=OPTIONS)
        for scheme in ("light", "dark"):
            for width, height, shown in zip(WIDTHS, HEIGHTS, SHOWN, strict=True):
                page = opened.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
                for kind in KINDS:
                    source = site / f"{kind}.html"
                    if not source.exists():
                        continue
                    page.goto(source.resolve().as_uri(), wait_until="load")
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
