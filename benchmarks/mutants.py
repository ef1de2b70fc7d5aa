"""Change lines of the code one by one and count what tests notice: `python benchmarks/mutants.py [--count 200]`.

A mutant is a copy of the checkout in which one line differs: a comparison, a sign, a product, `and` for `or`, a
condition turned round, or a number. Lines are drawn by a seed from `estimation`, `data` and `control`; each mutant is
tried by the tests of the folder that it lies in, until one of them fails. What survives is listed: code that no test of
its folder holds to what it does, or a line whose change makes no difference.
"""

import argparse
import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).parents[1]
LAYERS = ("estimation", "data", "control")
_LEFT_BEHIND = shutil.ignore_patterns(".*", "__pycache__", "site", "jupyter_execute", "demo")
_COMPARISONS = {
    "Lt": "<=", "LtE": "<", "Gt": ">=", "GtE": ">", "Eq": "!=", "NotEq": "==", "In": "not in", "NotIn": "in",
    "Is": "is not", "IsNot": "is",
}  # fmt: skip
_OPERATIONS = {"Add": "-", "Sub": "+", "Mult": "/", "Div": "*"}
_LONGEST_CPU = 900  # s of processor time after which a mutant counts as noticed: it never ends; chosen


@dataclass(frozen=True)
class Mutant:
    """A line that is changed.

    Attributes:
        path: of the file, from the root of the checkout.
        line: its number, from 1.
        before, after: the line.
    """

    path: Path
    line: int
    before: str
    after: str

    @property
    def tests(self) -> Path:
        """The folder of tests of the folder that it lies in, or of the nearest above that has tests."""
        folder = Path("tests", *self.path.parts[2:-1])
        while not any((REPOSITORY / folder).rglob("test_*.py")):
            folder = folder.parent
        return folder


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield every change of a line of a file."""
    text = (REPOSITORY / path).read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in _nodes_of_functions(ast.parse(text)):
        for start, end, instead in _changes(node):
            # columns of the tree count bytes
            row, before = start[0], lines[start[0] - 1].encode()
            if start[0] == end[0]:
                after = before[: start[1]] + instead.encode() + before[end[1] :]
                yield Mutant(path, row, before.decode(), after.decode())


def _nodes_of_functions(tree: ast.Module) -> Iterator[ast.AST]:
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef) and not any(
            "kernel" in ast.unparse(d) for d in function.decorator_list
        ):
            for statement in function.body:
                yield from ast.walk(statement)


def _changes(node: ast.AST) -> Iterator[tuple[tuple[int, int], tuple[int, int], str]]:
    """Yield start, end and what stands there instead, of the expression that a node is."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        operator = _COMPARISONS[type(node.ops[0]).__name__]
        yield *_place(node), f"{ast.unparse(node.left)} {operator} {ast.unparse(node.comparators[0])}"
    elif isinstance(node, ast.BinOp) and type(node.op).__name__ in _OPERATIONS:
        operator = _OPERATIONS[type(node.op).__name__]
        yield *_place(node), f"({ast.unparse(node.left)}) {operator} ({ast.unparse(node.right)})"
    elif isinstance(node, ast.BoolOp):
        operator = " or " if isinstance(node.op, ast.And) else " and "
        yield *_place(node), "(" + operator.join(f"({ast.unparse(value)})" for value in node.values) + ")"
    elif isinstance(node, ast.IfExp | ast.If):
        yield *_place(node.test), f"(not ({ast.unparse(node.test)}))"
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield *_place(node), repr(node.value + 1)


def _place(node: ast.expr) -> tuple[tuple[int, int], tuple[int, int]]:
    end = (node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)
    return (node.lineno, node.col_offset), end


def draw(count: int, seed: int) -> list[Mutant]:
    """Return that many mutants of different lines, in the order of files and lines."""
    files = [f for layer in LAYERS for f in sorted((REPOSITORY / "src/seatrial" / layer).rglob("*.py"))]
    by_line = dict[tuple[Path, int], list[Mutant]]()
    for mutant in (m for f in files for m in mutants_of(f.relative_to(REPOSITORY))):
        by_line.setdefault((mutant.path, mutant.line), []).append(mutant)
    rng = np.random.default_rng(seed)
    places = list(by_line)
    chosen = sorted(rng.choice(len(places), size=min(count, len(places)), replace=False).tolist())
    return [by_line[places[k]][int(rng.integers(len(by_line[places[k]])))] for k in chosen]


def is_noticed(mutant: Mutant, checkout: Path) -> bool:
    """Return whether a test of its folder fails in a copy of the checkout with the mutant; the copy is restored."""
    file = checkout / mutant.path
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    lines[mutant.line - 1] = mutant.after + "\n"
    file.write_text("".join(lines), encoding="utf-8")
    search = os.pathsep.join([str(checkout / "src"), str(checkout / "benchmarks")])
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", str(mutant.tests)]
    limited = ["bash", "-c", f'ulimit -t {_LONGEST_CPU}; exec "$@"', "bash", *command]
    try:
        environment = os.environ | {"PYTHONPATH": search}
        return subprocess.run(limited, cwd=checkout, env=environment, capture_output=True).returncode != 0
    finally:
        file.write_text(text, encoding="utf-8")


def main() -> None:
    """Print each mutant with its verdict, then the share that was noticed by folder of tests."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    noticed = dict[str, list[bool]]()
    with tempfile.TemporaryDirectory() as name:
        checkout = Path(name) / "checkout"
        shutil.copytree(REPOSITORY, checkout, ignore=_LEFT_BEHIND)
        for mutant in draw(options.count, options.seed):
            verdict = is_noticed(mutant, checkout)
            noticed.setdefault(str(mutant.tests), []).append(verdict)
            print(f"{'noticed ' if verdict else 'survived'} {mutant.path}:{mutant.line}")
            print(f"    - {mutant.before.strip()}\n    + {mutant.after.strip()}", flush=True)
    for folder, verdicts in noticed.items():
        print(f"{sum(verdicts):4d} of {len(verdicts):3d} {folder}")
    total = [verdict for verdicts in noticed.values() for verdict in verdicts]
    print(f"{sum(total):4d} of {len(total):3d} noticed, {sum(total) / len(total):.0%}")


if __name__ == "__main__":
    main()
