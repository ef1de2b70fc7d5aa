"""The pictures of the workspace's tour: its views over the example ship, by the machine's Chromium.

`python docs/photograph_workspace.py` drafts the logs of examples/ship, fits them in the page as a user does, and writes
``docs/pictures/workspace_VIEW.png``. It needs Chromium and playwright; elsewhere the committed pictures stay.
"""

import io
import shutil
import tempfile
import threading
from pathlib import Path

from contact_sheet import BROWSERS, OPTIONS
from PIL import Image
from playwright.sync_api import Page, sync_playwright

import seatrial as st
from seatrial.workspace import serve_workspace

REPOSITORY = Path(__file__).parents[1]
PICTURES = REPOSITORY / "docs" / "pictures"
LENGTH = 62.0  # m, of the ship of the examples, as the README has it
VIEWPORT = {"width": 1100, "height": 760}  # px
COLOURS = 64  # of a picture, so that it stays small; chosen


def main() -> None:
    """Serve the folder, walk through the views, and keep a picture of each."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        print("no pictures of the workspace: they need Chromium")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "ship"
        folder.mkdir()
        logs = [Path(shutil.copy(log, folder)) for log in sorted((REPOSITORY / "examples" / "ship").glob("*.csv"))]
        draft = st.draft_trial(*logs, folder=folder, length=LENGTH)
        (folder / "trial.toml").write_text(draft.text, encoding="utf-8")
        ready, ending, address = threading.Event(), threading.Event(), []

        def note(text: str) -> None:
            address.append(text)
            ready.set()

        server = threading.Thread(
            target=serve_workspace, args=(folder / "trial.toml", 0, note), kwargs={"ending": ending}, daemon=True
        )
        server.start()
        ready.wait()
        with sync_playwright() as playwright:
            opened = playwright.chromium.launch(executable_path=browser, args=OPTIONS)
            window = opened.new_page(viewport=VIEWPORT)
            window.goto(address[0])
            _walk(window)
            opened.close()
        ending.set()
        server.join()


def _walk(window: Page) -> None:
    """The way through: logs, craft, fit, what if, gains."""
    window.get_by_role("heading", name="Columns").wait_for()
    _keep(window, "logs")
    window.locator("#steps a[data-view='craft']").click()
    _keep(window, "craft")
    window.locator("#steps a[data-view='fit']").click()
    window.get_by_role("button", name="Start the fit").click()
    window.get_by_text("held-out").first.wait_for(timeout=300_000)  # ms
    _keep(window, "fit")
    window.get_by_role("button", name="What if").first.click()
    _keep(window, "whatif")
    window.locator("#steps a[data-view='gains']").click()
    window.get_by_role("button", name="Begin an autopilot").click()
    window.get_by_text("phase margin").first.wait_for(timeout=60_000)  # ms
    _keep(window, "gains")


def _keep(window: Page, view: str) -> None:
    window.wait_for_timeout(2000)  # ms, until curves are drawn; chosen
    path = PICTURES / f"workspace_{view}.png"
    Image.open(io.BytesIO(window.screenshot())).convert("RGB").quantize(COLOURS).save(path, optimize=True)
    print(path.relative_to(REPOSITORY))


if __name__ == "__main__":
    main()
