"""The pictures of the workspace's tour: its views over the example ship, by the machine's Chromium.

`python docs/photograph_workspace.py` drafts the logs of examples/ship, fits them in the page as a user does, follows a
log, and writes ``docs/pictures/workspace_VIEW.png``. It needs Chromium and playwright; else the committed
pictures stay.
"""

import io
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

import seatrial as st
from seatrial.workspace import workspace_beside

REPOSITORY = Path(__file__).parents[1]
PICTURES, EXAMPLES = REPOSITORY / "docs" / "pictures", REPOSITORY / "examples"
LENGTH = 62.0  # m, of the ship of the examples, as the README has it
VIEWPORT = {"width": 1100, "height": 760}  # px
COLOURS = 64  # of a picture, so that it stays small; chosen
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]


def main() -> None:
    """Serve both folders, walk through the views, and keep a picture of each."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        print("no pictures of the workspace: they need Chromium")
        return
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=browser, args=OPTIONS)
        for trial, walk in ((ship_of_examples(Path(name)), _walk), (followed_craft(Path(name)), _walk_on_board)):
            with workspace_beside(trial) as (_, address):
                window = opened.new_page(viewport=VIEWPORT)
                window.goto(address)
                walk(window)
                window.close()
        opened.close()


def ship_of_examples(parent: Path) -> Path:
    """Draft the ship of the examples in a folder of its own, and return the trial file."""
    folder = parent / "ship"
    folder.mkdir()
    logs = [Path(shutil.copy(log, folder)) for log in sorted((EXAMPLES / "ship").glob("*.csv"))]
    draft = st.draft_trial(*logs, folder=folder, length=LENGTH)
    (folder / "trial.toml").write_text(draft.text, encoding="utf-8")
    return folder / "trial.toml"


def followed_craft(parent: Path) -> Path:
    """Copy the craft that is followed in the examples, and return the trial file."""
    shutil.copytree(EXAMPLES / "waterjet", parent / "craft" / "waterjet")
    return Path(shutil.copy(EXAMPLES / "waterjet_follow.toml", parent / "craft"))


def _walk(window: Page) -> None:
    """The way through: logs, craft, fit, what if, gains."""
    window.get_by_role("heading", name="Columns").wait_for()
    _keep(window, "logs")
    window.locator("#steps a[data-view='craft']").click()
    _keep(window, "craft")
    window.locator("#steps a[data-view='fit']").click()
    window.get_by_role("button", name="Start the fit").click()
    window.get_by_text("held-out").first.wait_for(timeout=120_000)  # ms
    _keep(window, "fit")
    window.get_by_role("button", name="What if").first.click()
    _keep(window, "whatif")
    window.locator("#steps a[data-view='gains']").click()
    window.get_by_role("button", name="Begin an autopilot").click()
    window.get_by_text("phase margin").first.wait_for(timeout=60_000)  # ms
    _keep(window, "gains")


def _walk_on_board(window: Page) -> None:
    """An estimate that grows."""
    follow_log(window)
    _keep(window, "onboard")


def follow_log(window: Page) -> None:
    """Follow the log of the craft until most of it is read."""
    window.get_by_role("heading", name="Columns").wait_for()
    window.locator("#steps a[data-view='onboard']").click()
    window.get_by_role("button", name="Follow", exact=True).click()
    window.get_by_text("following", exact=True).first.wait_for(timeout=60_000)  # ms
    window.wait_for_timeout(15_000)  # ms, until most of the log is read; chosen


def _keep(window: Page, view: str) -> None:
    window.wait_for_timeout(2000)  # ms, until curves are drawn; chosen
    path = PICTURES / f"workspace_{view}.png"
    Image.open(io.BytesIO(window.screenshot())).convert("RGB").quantize(COLOURS).save(path, optimize=True)
    print(path.relative_to(REPOSITORY))


if __name__ == "__main__":
    main()
