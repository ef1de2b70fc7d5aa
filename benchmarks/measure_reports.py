"""Words and height of pages before anything is unfolded, and whether a page is cut.

`python benchmarks/measure_reports.py PAGE.html ...` prints a row for each page: words that stand on it, its height at a
desk's and a telephone's width [px], its weight, and at which width it sticks out of the window. It returns 1 where a
page has more words, or is higher at a desk, than it may be, or is cut. It needs Chromium and playwright. With
`--pictures FOLDER` it keeps a photograph of each at both widths.
"""

import argparse
import shutil
import sys
from pathlib import Path

MOST_WORDS, MOST_PX = 1500, 6000  # of a page at a desk, before unfolding; chosen
WIDTHS = (1400, 390)  # px, of a desk and of a telephone
VISIBLE_WORDS = "document.body.innerText.split(/\\s+/).filter(text => /[\\p{L}\\p{N}]/u.test(text)).length"
HEIGHT, WIDTH = (f"document.documentElement.scroll{side}" for side in ("Height", "Width"))


def main(arguments: list[str]) -> int:
    """Print a row for each page; return 1 where one is too long or cut."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description="words and height of pages before anything is unfolded")
    parser.add_argument("pages", type=Path, nargs="+")
    parser.add_argument("--pictures", type=Path)
    options, is_long = parser.parse_args(arguments), False
    print(f"{'page':44}{'words':>7}{'px':>7}{'px, phone':>11}{'kB':>7}  cut at")
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for path in options.pages:
            words, heights, cut = 0, [], []
            for width in WIDTHS:
                window = opened.new_page(viewport={"width": width, "height": 900})
                window.goto(path.resolve().as_uri(), wait_until="load")
                words = words or window.evaluate(VISIBLE_WORDS)
                heights.append(window.evaluate(HEIGHT))
                cut += [str(width)] if window.evaluate(WIDTH) > width else []
                if options.pictures:
                    options.pictures.mkdir(parents=True, exist_ok=True)
                    name = "-".join(path.with_suffix("").parts[-3:])
                    window.screenshot(path=options.pictures / f"{name}-{width}.png", full_page=True)
                window.close()
            name = "/".join(path.parts[-3:])
            print(f"{name:44}{words:7}{heights[0]:7}{heights[1]:11}{path.stat().st_size / 1e3:7.0f}  {' '.join(cut)}")
            is_long |= words > MOST_WORDS or heights[0] > MOST_PX or bool(cut)
        opened.close()
    return int(is_long)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
