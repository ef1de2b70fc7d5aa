"""Draw the layers of the package from its imports: `python docs/draw_architecture.py`.

Writes docs/pictures/architecture.svg and the table of subpackages in docs/architecture.md. The rows are those of the
import contract "Layers" in pyproject.toml. An arrow is an import anywhere in a subpackage, inside functions and for
type checkers included, but not the contract's named exceptions; drawn are those that no chain of others implies.
"""

import ast
import sys
import tomllib
from dataclasses import dataclass
from html import escape
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
SOURCE = REPOSITORY / "src"
PAGE = REPOSITORY / "docs" / "architecture.md"
PICTURE = REPOSITORY / "docs" / "pictures" / "architecture.svg"
BEGIN, END = "<!-- written by draw_architecture.py -->", "<!-- end -->"

Arrows = dict[str, set[str]]

# Geometry of the picture, in px; chosen by eye for a page 960 px wide.
WIDTH, LABEL_WIDTH, BOX_WIDTH, BOX_HEIGHT, ROW_HEIGHT, MARGIN = 960, 110, 108, 30, 78, 12
COLOURS = ("#1f5f8b", "#8a4b08", "#2e7d5b", "#7a3b69", "#55606b", "#8e6c1f", "#3949ab", "#a33c3c", "#00695c", "#444444")


@dataclass(frozen=True)
class Box:
    """A subpackage in the picture: its top left corner in px and the row it stands in."""

    x: float
    y: float
    row: int

    @property
    def centre(self) -> float:
        """Return the horizontal centre in px."""
        return self.x + BOX_WIDTH / 2


def layers() -> list[list[str]]:
    """Return the layers from the highest to the lowest, each with its subpackages, as the import contracts order them.

    The command line and the functions behind it, `cli` and `api`, are one layer; modules of the package itself, whose
    names begin with an underscore, are none.
    """
    order = {c["containers"][0]: c["layers"] for c in _contracts() if c["type"] == "layers"}
    rows = []
    for row in order.pop("seatrial"):
        names = [name for name in _siblings(row) if not name.startswith("_")]
        if not names:
            continue
        if names[0].startswith("_"):
            continue
        inner = order.get(f"seatrial.{names[0]}")
        rows.append([f"{names[0]}.{n}" for line in inner for n in _siblings(line)] if inner else names)
    return [rows[0] + rows[1], *rows[2:]] if rows[:2] == [["cli"], ["api"]] else rows


def exceptions() -> set[tuple[str, str]]:
    """Return importing and imported module of each upward import that the contracts allow by name."""
    lines = [line for contract in _contracts() for line in contract.get("ignore_imports", [])]
    return {(importer.strip(), target.strip()) for importer, _, target in (line.partition("->") for line in lines)}


def _contracts() -> list[dict]:
    text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["tool"]["importlinter"]["contracts"]


def _siblings(row: str) -> list[str]:
    return [name.strip(" ()") for name in row.replace(":", "|").split("|")]


def arrows(subpackages: list[str]) -> Arrows:
    """Return which subpackages each subpackage imports, from the source text alone."""
    drawn: Arrows = {name: set() for name in subpackages}
    for path in sorted((SOURCE / "seatrial").rglob("*.py")):
        module = ".".join(path.relative_to(SOURCE).with_suffix("").parts)
        importer = subpackage_of(module, subpackages)
        if importer is None:
            continue
        allowed = tuple(target for name, target in exceptions() if name == module)
        for imported in imported_modules(path):
            target = subpackage_of(imported, subpackages)
            if target not in (None, importer) and not imported.startswith(allowed):
                drawn[importer].add(target)
    return drawn


def imported_modules(path: Path) -> list[str]:
    """Return the dotted names a file imports, each imported name appended to its module."""
    modules: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            modules += [f"{node.module}.{alias.name}" for alias in node.names]
    return modules


def subpackage_of(module: str, subpackages: list[str]) -> str | None:
    """Return the subpackage a dotted module name lies in, None outside all of them."""
    parts = module.split(".")
    if parts[0] != "seatrial":
        return None
    return next((name for name in subpackages if parts[1 : 1 + name.count(".") + 1] == name.split(".")), None)


def reduced(graph: Arrows) -> Arrows:
    """Return the arrows that no chain of other arrows implies."""
    below: Arrows = {}

    def reach(name: str) -> set[str]:
        if name not in below:
            below[name] = set(graph[name]).union(*(reach(target) for target in graph[name]))
        return below[name]

    return {
        name: {t for t in targets if not any(t in reach(between) for between in targets - {t})}
        for name, targets in graph.items()
    }


def picture(rows: list[list[str]], graph: Arrows) -> str:
    """Return the SVG of the layers: one band a layer, one box a subpackage, arrows towards what is imported."""
    height = MARGIN * 2 + ROW_HEIGHT * len(rows)
    boxes: dict[str, Box] = {}
    for k, row in enumerate(rows):
        step = (WIDTH - LABEL_WIDTH - MARGIN) / len(row)
        for j, name in enumerate(row):
            x = LABEL_WIDTH + step * (j + 0.5) - BOX_WIDTH / 2
            boxes[name] = Box(round(x, 1), MARGIN + k * ROW_HEIGHT + (ROW_HEIGHT - BOX_HEIGHT) / 2, k)
    total, essential = sum(map(len, graph.values())), reduced(graph)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        'font-family="Helvetica, Arial, sans-serif" font-size="12">',
        f"<title>{len(rows)} layers, {len(boxes)} subpackages, {total} imports between them</title>",
        "<style>path:hover{stroke-width:4;opacity:1}</style>",
        '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0L8 4L0 8z" fill="#33404c"/></marker>',
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    for k, row in enumerate(rows):
        top = MARGIN + k * ROW_HEIGHT + 5
        label = " and ".join(dict.fromkeys(name.split(".")[0] for name in row)) if "." in row[0] else ""
        parts.append(
            f'<rect x="{MARGIN}" y="{top}" width="{WIDTH - 2 * MARGIN}" height="{ROW_HEIGHT - 10}" rx="6" '
            f'fill="{"#f3f6f8" if k % 2 else "#eaf0f4"}"/>'
            f'<text x="{MARGIN + 10}" y="{top + ROW_HEIGHT / 2 - 1}" font-weight="bold" fill="#33404c">{label}</text>'
        )
    for name, targets in essential.items():
        for target in sorted(targets):
            parts.append(_arrow(name, target, boxes))
    for name, box in boxes.items():
        parts.append(
            f'<rect x="{box.x}" y="{box.y}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="4" fill="#ffffff" '
            f'stroke="{_colour(box)}" stroke-width="1.4"/>'
            f'<text x="{box.centre}" y="{box.y + 19}" text-anchor="middle">{escape(name.split(".")[-1])}</text>'
        )
    return "\n".join([*parts, "</svg>", ""])


def _arrow(name: str, target: str, boxes: dict[str, Box]) -> str:
    start, end = boxes[name], boxes[target]
    if start.row == end.row:
        rise = 9 + 0.02 * abs(end.centre - start.centre)
        sign = 1 if end.centre > start.centre else -1
        y = start.y
        x0, x1 = start.centre + sign * BOX_WIDTH / 4, end.centre - sign * BOX_WIDTH / 4
        path = f"M{x0:.1f} {y}C{x0:.1f} {y - rise:.1f} {x1:.1f} {y - rise:.1f} {x1:.1f} {y - 1}"
    else:
        lean = 0.35 * BOX_WIDTH * max(-1.0, min(1.0, (end.centre - start.centre) / WIDTH * 3))
        x0, y0, x1, y1 = start.centre + lean, start.y + BOX_HEIGHT, end.centre - lean, end.y - 1
        bend = 0.45 * (y1 - y0)
        path = f"M{x0:.1f} {y0}C{x0:.1f} {y0 + bend:.1f} {x1:.1f} {y1 - bend:.1f} {x1:.1f} {y1}"
    return (
        f'<path d="{path}" fill="none" stroke="{_colour(start)}" stroke-width="1.3" opacity="0.7" '
        f'marker-end="url(#tip)"><title>{name} imports {target}</title></path>'
    )


def _colour(box: Box) -> str:
    return COLOURS[(box.row + int(box.x / BOX_WIDTH)) % len(COLOURS)]


def table(rows: list[list[str]], graph: Arrows) -> str:
    """Return one line a subpackage: its name, what its docstring says it offers, and where its drawn arrows lead."""
    direct = reduced(graph)
    lines = ["| subpackage | what it offers | builds on |", "|---|---|---|"]
    for name in (name for row in rows for name in row):
        path = SOURCE / "seatrial" / Path(*name.split("."))
        text = (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).read_text(encoding="utf-8")
        summary = (ast.get_docstring(ast.parse(text)) or "").partition("\n\n")[0].replace("\n", " ")
        targets = [t.split(".")[-1] for row in rows for t in row if t in direct[name]]
        lines.append(f"| `{name}` | {summary} | {', '.join(targets)} |")
    return "\n".join(lines)


def page(rows: list[list[str]], graph: Arrows) -> str:
    """Return the text of docs/architecture.md with the part between its two markers renewed."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    total, shown = sum(map(len, graph.values())), sum(map(len, reduced(graph).values()))
    caption = (
        f"{len(rows)} layers, {len(graph)} subpackages, {total} imports between them; drawn are the {shown} that no "
        f"chain of others implies.\n{len(exceptions())} imports upwards, each inside one method, are named in "
        "pyproject.toml."
    )
    picture_line = "![The layers of seatrial, drawn from its imports](pictures/architecture.svg)"
    return f"{before}{BEGIN}\n\n{picture_line}\n\n{caption}\n\n{table(rows, graph)}\n\n{END}{after}"


def drawn_files() -> dict[Path, str]:
    """Return the files this command writes, by path."""
    rows = layers()
    graph = arrows([name for row in rows for name in row])
    return {PICTURE: picture(rows, graph), PAGE: page(rows, graph)}


def main() -> int:
    """Write the picture and the table; with `--check` only say whether they are current."""
    stale = [path for path, text in drawn_files().items() if not path.exists() or path.read_text("utf-8") != text]
    if "--check" in sys.argv[1:]:
        for path in stale:
            print(f"{path.relative_to(REPOSITORY)} is not current; run python docs/draw_architecture.py")
        return int(bool(stale))
    for path, text in drawn_files().items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
