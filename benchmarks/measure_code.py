"""Count the code: `python benchmarks/measure_code.py [--commit REVISION] [--record]`.

A copy is formatted by ruff at 120 columns, without `# fmt: skip` and magic trailing commas, so that no way of breaking
lines is rewarded. A line counts unless it is blank, a comment, or part of a docstring (any text that stands alone).
A numeric constant is a module's name in capitals whose value is a number or an expression with one; of a table each row
that is a number. Counts of types (`types.Array`) and positions (`parents[2]`) are no constants. Lines of tests are all
lines of their Python files as they stand.

The totals are the budgets of `code_budget.toml`, beside this file. `--record` lowers them to the present figures. A
figure above its budget needs a row there with its reason.
"""

import argparse
import ast
import io
import re
import subprocess
import sys
import tarfile
import tempfile
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import tomlkit

REPOSITORY = Path(__file__).parents[1]
BUDGET = Path(__file__).with_name("code_budget.toml")
FIGURES = ("lines", "files", "classes", "constants", "study_lines", "test_lines", "toml", "html", "js", "css")
"""What has a budget; the last four are lines that are not blank, in src."""
_FORMAT = 'line-length = 120\ntarget-version = "py311"\n[format]\nskip-magic-trailing-comma = true\n'
_SKIP = re.compile(r"[ \t]*# fmt: ?(?:skip|off|on)\b")
_NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
_TABLES = ast.Dict | ast.Tuple | ast.List | ast.Set
_SHEETS = ("toml", "html", "js", "css")


def measure(root: Path) -> dict[str, Counter[str]]:
    """Return the counts of a checkout by area: `seatrial/...`, `seatrial_studies`, `tests`."""
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name)
        write_formatted(root, copy)
        areas: dict[str, Counter[str]] = {}
        for path in sorted((copy / "src").rglob("*.py")):
            area = areas.setdefault(_area(path.relative_to(copy / "src")), Counter())
            area.update(count_file(path.read_text(encoding="utf-8")))
    for kind in _SHEETS:
        for path in (root / "src").rglob(f"*.{kind}"):
            area = areas.setdefault(_area(path.relative_to(root / "src")), Counter())
            area[kind] += sum(bool(line.strip()) for line in path.read_text(encoding="utf-8").splitlines())
    tests = [path.read_text(encoding="utf-8") for path in (root / "tests").rglob("*.py")]
    areas["tests"] = Counter(lines=sum(text.count("\n") for text in tests), files=len(tests))
    return areas


def write_formatted(root: Path, copy: Path) -> None:
    """Write the Python files of src into `copy`, formatted without exceptions."""
    for path in (root / "src").rglob("*.py"):
        target = copy / path.relative_to(root)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(_SKIP.sub("", path.read_text(encoding="utf-8")), encoding="utf-8")
    (copy / "ruff.toml").write_text(_FORMAT)
    command = [sys.executable, "-m", "ruff", "format", "--quiet", "--no-cache", "--config", "ruff.toml", "."]
    subprocess.run(command, cwd=copy, check=True)


def count_file(text: str) -> Counter[str]:
    """Return lines, classes and numeric constants of one formatted file."""
    tree = ast.parse(text)
    code = {
        number
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in _NO_CODE
        for number in range(token.start[0], token.end[0] + 1)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            code -= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    stripped = [line.strip() for line in text.split("\n")]
    lines = sum(bool(stripped[number - 1]) and not stripped[number - 1].startswith("#") for number in code)
    classes = sum(isinstance(node, ast.ClassDef) for node in ast.walk(tree))
    constants = sum(_numbers(value) for name, value in _assignments(tree) if name.strip("_").isupper())
    return Counter(lines=lines, files=1, classes=classes, constants=constants)


def _area(path: Path) -> str:
    package, *inner = path.parts[:-1]
    return package if package == "seatrial_studies" else "/".join([package, *inner[:2]])


def _assignments(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        names = [name.id for target in targets if target for name in ast.walk(target) if isinstance(name, ast.Name)]
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and names:
            yield names[0], node.value


def _numbers(value: ast.expr) -> int:
    if isinstance(value, _TABLES):
        rows = value.values if isinstance(value, ast.Dict) else value.elts
        return sum(_is_number(row) for row in rows)
    is_type = isinstance(value, ast.Call) and ast.unparse(value.func).startswith("types.")
    return int(not is_type and not isinstance(value, ast.Subscript) and any(map(_is_number, ast.walk(value))))


def _is_number(node: ast.AST | None) -> bool:
    if isinstance(node, ast.UnaryOp):
        return _is_number(node.operand)
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def totals(areas: dict[str, Counter[str]]) -> dict[str, int]:
    """Return the figures that have a budget."""
    package = sum((counts for area, counts in areas.items() if area.startswith("seatrial/") or area == "seatrial"),
                  Counter())  # fmt: skip
    other = {"study_lines": areas["seatrial_studies"]["lines"], "test_lines": areas["tests"]["lines"]}
    other |= {kind: sum(counts[kind] for counts in areas.values()) for kind in _SHEETS}
    return {name: other.get(name, package[name]) for name in FIGURES}


def over_budget(figures: dict[str, int], document: dict) -> list[str]:
    """Return a sentence for every figure above its budget and what its rows of reasons allow."""
    allowed = Counter(document["budget"])
    for row in document.get("raised", []):
        if row["reason"].strip():
            allowed[row["figure"]] += row["by"]
    return [
        f"{name}: {figure} is {figure - allowed[name]} above the budget of {allowed[name]}; lower another part of it, "
        f"or say why in one line of benchmarks/{BUDGET.name}: [[raised]] figure, by, reason"
        for name, figure in figures.items()
        if figure > allowed[name]
    ]


def record(figures: dict[str, int]) -> None:
    """Lower the budgets to the present figures; reasons stay where the figure is still above its budget."""
    document = tomlkit.parse(BUDGET.read_text(encoding="utf-8"))
    budget = document["budget"]
    for name, figure in figures.items():
        budget[name] = min(figure, budget.get(name, figure))  # type: ignore[index,union-attr]
    rows = [row for row in document.get("raised", []) if figures[row["figure"]] > budget[row["figure"]]]  # type: ignore[index]
    document.pop("raised", None)
    if rows:
        table = tomlkit.aot()
        for row in rows:
            table.append(tomlkit.item(dict(row)))
        document["raised"] = table
    BUDGET.write_text(tomlkit.dumps(document), encoding="utf-8")


def checkout(revision: str, folder: Path) -> None:
    """Unpack src and tests of a revision."""
    command = ["git", "-C", str(REPOSITORY), "archive", revision, "src", "tests"]
    packed = subprocess.run(command, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")


def main() -> int:
    """Print the counts by area and the totals beside their budgets."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--commit", help="count this revision instead of the files at hand")
    parser.add_argument("--record", action="store_true", help="lower the budgets to the present figures")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        if options.commit:
            checkout(options.commit, Path(name))
        areas = measure(Path(name) if options.commit else REPOSITORY)
    columns = ("lines", "files", "classes", "constants", *_SHEETS)
    print(f"{'area':32s}" + "".join(f"{column:>10s}" for column in columns))
    for area, counts in areas.items():
        print(f"{area:32s}" + "".join(f"{counts[column] or '':>10}" for column in columns))
    figures = totals(areas)
    if options.record and not options.commit:
        record(figures)
    document = tomllib.loads(BUDGET.read_text(encoding="utf-8"))
    print()
    for figure_name, figure in figures.items():
        print(f"{figure_name:14s}{figure:8d}   budget {document['budget'].get(figure_name, 0):8d}")
    excess = [] if options.commit else over_budget(figures, document)
    print(*excess, sep="\n", end="\n" if excess else "")
    return int(bool(excess))


if __name__ == "__main__":
    sys.exit(main())
