"""Texts of the source as somebody reads them: parts joined, the longest of several, other values as a letter."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from tests.conventions.source_tree import Function, SourceFile

VALUE = "X"
Assigned = Mapping[str, list[ast.expr]]


def joined_texts(file: SourceFile) -> Iterator[tuple[ast.expr, str]]:
    """Yield the texts of a file that are no docstrings, each with its node; what is named or returned is looked up."""
    reader = _Reader(file)
    return reader.texts(file.tree, (reader.assigned(file.tree),))


def _longest(texts: Iterable[str]) -> str:
    return max(texts, key=lambda text: len(text.split()), default=VALUE)


def _inside(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what stands in a function or module, other functions and classes left out."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, Function | ast.ClassDef | ast.Lambda):
            yield child
            yield from _inside(child)


@dataclass
class _Reader:
    """Reads expressions of one file.

    Attributes:
        open: names that are being looked up, which mean nothing to themselves.
    """

    file: SourceFile
    open: set[int] = field(default_factory=set)

    @cached_property
    def functions(self) -> Mapping[str, Function]:
        return {node.name: node for node in self.file.nodes if isinstance(node, Function)}

    def assigned(self, node: ast.AST) -> Assigned:
        values: dict[str, list[ast.expr]] = {}
        for inner in _inside(node):
            if isinstance(inner, ast.Assign | ast.AnnAssign) and inner.value is not None:
                for target in inner.targets if isinstance(inner, ast.Assign) else [inner.target]:
                    values.setdefault(ast.unparse(target), []).append(inner.value)
        return values

    def texts(self, node: ast.AST, scopes: tuple[Assigned, ...]) -> Iterator[tuple[ast.expr, str]]:
        scopes = (self.assigned(node), *scopes[-1:]) if isinstance(node, Function) else scopes
        for child in ast.iter_child_nodes(node):
            match child:
                case ast.JoinedStr() | ast.BinOp(op=ast.Add()) | ast.Constant(value=str()):
                    if not isinstance(node, ast.Expr):  # a docstring or the text of an attribute
                        yield child, self.read(child, scopes)
                case _:
                    yield from self.texts(child, scopes)

    def read(self, node: ast.expr, scopes: tuple[Assigned, ...]) -> str:
        match node:
            case ast.Constant(value=str(text)):
                return text
            case ast.JoinedStr(values=parts):
                return "".join(self.read(part, scopes) for part in parts)
            case ast.FormattedValue(value=value):
                return self.read(value, scopes)
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return self.read(left, scopes) + self.read(right, scopes)
            case ast.IfExp(body=body, orelse=other):
                return _longest(self.read(part, scopes) for part in (body, other))
            case ast.BoolOp(values=parts):
                return _longest(self.read(part, scopes) for part in parts)
            case ast.Name(id=name):
                values = next((scope[name] for scope in scopes if name in scope), [])
                return self.looked_up(values, scopes)
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(id="self" | "cls"), attr=name)):
                function = self.functions.get(name)
                returned = [] if function is None else [n.value for n in _inside(function) if isinstance(n, ast.Return)]
                inner = scopes if function is None else (self.assigned(function), *scopes[-1:])
                return self.looked_up([value for value in returned if value is not None], inner)
        return VALUE

    def looked_up(self, values: list[ast.expr], scopes: tuple[Assigned, ...]) -> str:
        fresh = [value for value in values if id(value) not in self.open]
        self.open |= {id(value) for value in fresh}
        text = _longest(self.read(value, scopes) for value in fresh)
        self.open -= {id(value) for value in fresh}
        return text
