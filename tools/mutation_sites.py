"""Where a module's source can be mutated, and into what.

Docstrings, annotations, decorators, messages of errors, logging, the looks of figures, and what
only type checkers read are left alone. A comparison of whole numbers is made to hold at equality,
or not to. One of others, which are hardly ever equal, is turned round; what it says of equality is
a mutant of its own kind, a tie.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

KINDS = ("body", "arithmetic", "comparison", "constant", "condition", "index", "statement", "tie")

_ARITHMETIC: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "%"),
    ast.Mod: ("%", "//"),
    ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
}
_COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: (r"<", "<="),
    ast.LtE: (r"<=", "<"),
    ast.Gt: (r">", ">="),
    ast.GtE: (r">=", ">"),
    ast.Eq: (r"==", "!="),
    ast.NotEq: (r"!=", "=="),
    ast.Is: (r"\bis\b", "is not"),
    ast.IsNot: (r"\bis\s+not\b", "is"),
    ast.In: (r"\bin\b", "not in"),
    ast.NotIn: (r"\bnot\s+in\b", "in"),
}
_REVERSED: dict[type[ast.cmpop], str] = {ast.Lt: ">", ast.LtE: ">", ast.Gt: "<", ast.GtE: "<"}
# What is compared with these, or with a whole number, can be equal to it.
_WHOLE = re.compile(r"\blen\(|\.(size|ndim|shape)\b|\b(count|index|number|[i-n])\b|^-?\d+$")
_NEUTRAL = {
    "bool": "False",
    "bytes": 'b""',
    "dict": "{}",
    "float": "0.0",
    "frozenset": "frozenset()",
    "int": "0",
    "list": "[]",
    "set": "set()",
    "str": '""',
    "Iterable": "()",
    "Iterator": "iter(())",
    "Mapping": "{}",
    "Sequence": "()",
}
_TYPES = {
    *_NEUTRAL,
    "tuple",
    "type",
    "object",
    "Annotated",
    "Any",
    "Callable",
    "Literal",
    "NDArray",
}
_SPOKEN = re.compile(r"^(_?log(ger|ging)?\b|print$|warnings\.|typer\.s?echo|(terminal\.)?say$)")
# How a figure looks: no test should pin it.
_LOOKS = frozenset(
    {"alpha", "color", "dpi", "figsize", "fontsize", "gridspec_kw", "height_ratios", "labelpad"}
    | {"labelsize", "length", "linewidth", "linewidths", "lw", "marker", "markersize", "ms", "ncol"}
    | {"pad", "rotation", "s", "width", "width_ratios", "x", "y", "zorder"}
)
_NO_BEHAVIOUR = frozenset({"indent", "stacklevel"})


@dataclass(frozen=True)
class Site:
    """One span of a source's bytes, in one function, and the text that could stand there."""

    kind: str
    function: str  # "" at the level of the module or a class
    start: int
    end: int
    after: str


def sites(source: bytes, quantities: Iterable[str], draws: bool) -> list[Site]:
    """Every place of a module: `quantities` are types that are floats, `draws` says: figures."""
    collector = _Collector(source, frozenset(quantities), _LOOKS if draws else frozenset())
    collector.statements(ast.parse(source).body, "")
    return collector.found


class _Collector:
    """Walks a module's tree and writes down what may be changed."""

    def __init__(self, source: bytes, quantities: frozenset[str], looks: frozenset[str]) -> None:
        self.found: list[Site] = []
        self._source, self._quantities, self._looks = source, quantities, looks | _NO_BEHAVIOUR
        self._lines = [0]
        for line in source.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))

    # -- places in the text

    def _start(self, node: ast.expr | ast.stmt) -> int:
        return self._lines[node.lineno - 1] + node.col_offset

    def _end(self, node: ast.expr | ast.stmt) -> int:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._lines[node.end_lineno - 1] + node.end_col_offset

    def _text(self, node: ast.expr | ast.stmt) -> str:
        return self._source[self._start(node) : self._end(node)].decode()

    def _add(self, kind: str, function: str, start: int, end: int, after: str) -> None:
        self.found.append(Site(kind, function, start, end, after))

    def _replace(self, kind: str, function: str, node: ast.expr | ast.stmt, after: str) -> None:
        self._add(kind, function, self._start(node), self._end(node), after)

    def _operator(
        self, kind: str, function: str, span: tuple[int, int], pattern: str, after: str
    ) -> None:
        gap = re.sub(rb"#[^\n]*", lambda hit: b" " * len(hit[0]), self._source[slice(*span)])
        hit = re.search(pattern.encode(), gap)
        if hit:
            self._add(kind, function, span[0] + hit.start(), span[0] + hit.end(), after)

    # -- statements

    def statements(self, body: list[ast.stmt], function: str) -> None:
        """The mutants of a block of statements."""
        assigned: set[str] = set()
        for statement in body:
            if _is_left_alone(statement):
                continue
            if function and self._is_deletable(statement, assigned):
                self._replace("statement", function, statement, "pass")
            if isinstance(statement, ast.Assign | ast.AnnAssign):
                targets = (
                    statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                )
                assigned |= {target.id for target in targets if isinstance(target, ast.Name)}
            self._statement(statement, function)

    @staticmethod
    def _is_deletable(statement: ast.stmt, assigned: set[str]) -> bool:
        if isinstance(statement, ast.Assign):
            return all(
                not isinstance(target, ast.Name | ast.Tuple)
                or getattr(target, "id", "") in assigned
                for target in statement.targets
            )
        simple = ast.AugAssign | ast.Expr | ast.Raise | ast.Continue | ast.Break | ast.Delete
        return isinstance(statement, simple)

    def _statement(self, node: ast.stmt, function: str) -> None:
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                inner = f"{function}.{node.name}".lstrip(".")
                for default in [*node.args.defaults, *node.args.kw_defaults]:
                    self._expression(default, inner)
                self._body(node, inner)
                self.statements(node.body, inner)
            case ast.ClassDef():
                self.statements(node.body, "")
            case ast.Raise():
                return  # deleted, or left as it is: its message is no behaviour
            case ast.AnnAssign():
                self._expression(node.value, function)
            case ast.AugAssign():
                old, new = _ARITHMETIC.get(type(node.op), ("", ""))
                if old:
                    span = (self._end(node.target), self._start(node.value))
                    self._operator("arithmetic", function, span, re.escape(old) + "=", f"{new}=")
                self._expression(node.target, function)
                self._expression(node.value, function)
            case _:
                if isinstance(node, ast.If | ast.While):
                    self._negate(node.test, function)
                for field in ast.iter_fields(node):
                    self._field(field[1], function)

    def _field(self, value: object, function: str) -> None:
        items = value if isinstance(value, list) else [value]
        self.statements([item for item in items if isinstance(item, ast.stmt)], function)
        for item in items:
            if isinstance(item, ast.expr):
                self._expression(item, function)
            elif isinstance(item, ast.AST) and not isinstance(item, ast.stmt):
                for inner in ast.iter_fields(item):
                    self._field(inner[1], function)

    def _body(self, node: ast.FunctionDef | ast.AsyncFunctionDef, function: str) -> None:
        body = node.body[1:] if ast.get_docstring(node) is not None else node.body
        decorators = " ".join(map(ast.unparse, node.decorator_list))
        hollow = all(isinstance(item, ast.Raise | ast.Pass) or _is_ellipsis(item) for item in body)
        if hollow or "contextmanager" in decorators or "overload" in decorators:
            return
        if any(isinstance(inner, ast.Yield | ast.YieldFrom) for inner in _own_nodes(node)):
            after = "yield from ()"
        else:
            after = f"return {self._neutral(node)}"
        self._add("body", function, self._start(body[0]), self._end(body[-1]), after)

    def _neutral(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> str:
        if node.returns is None:
            return "None"
        wanted = ast.unparse(node.returns)
        for argument in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]:
            if argument.annotation and ast.unparse(argument.annotation) == wanted:
                return argument.arg
        return self._neutral_of(node.returns)

    def _neutral_of(self, annotation: ast.expr) -> str:
        if isinstance(annotation, ast.Subscript):
            name, inner = ast.unparse(annotation.value), annotation.slice
            if name == "tuple":
                parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
                if isinstance(parts[-1], ast.Constant):  # tuple[X, ...]
                    return "()"
                return f"({', '.join(map(self._neutral_of, parts))},)"
            return _NEUTRAL.get(name, "None")
        name = ast.unparse(annotation)
        return "0.0" if name in self._quantities else _NEUTRAL.get(name, "None")

    # -- expressions

    def _expression(self, node: ast.expr | None, function: str) -> None:
        match node:
            case None | ast.JoinedStr():
                return
            case ast.Constant():
                self._constant(node, function)
            case ast.BinOp():
                self._arithmetic(node, function)
            case ast.Compare():
                self._comparisons(node, function)
            case ast.BoolOp():
                old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
                span = (self._end(node.values[0]), self._start(node.values[1]))
                self._operator("condition", function, span, rf"\b{old}\b", new)
            case ast.UnaryOp(op=ast.USub()) if not isinstance(node.operand, ast.Constant):
                self._add("arithmetic", function, self._start(node), self._start(node) + 1, "+")
            case ast.IfExp():
                self._negate(node.test, function)
            case ast.ListComp() | ast.SetComp() | ast.GeneratorExp() | ast.DictComp():
                for generator in node.generators:
                    for condition in generator.ifs:
                        self._negate(condition, function)
            case ast.Subscript():
                if ast.unparse(node.value).rpartition(".")[2] not in _TYPES:
                    self._expression(node.value, function)
                    self._index(node.slice, function)
                return
            case ast.Call():
                self._call(node, function)
                return
            case _:
                pass
        if node is not None and not isinstance(node, ast.Constant):
            for field in ast.iter_fields(node):
                self._field(field[1], function)

    def _call(self, node: ast.Call, function: str) -> None:
        name = ast.unparse(node.func).rpartition(".")[2]
        if name.endswith(("Error", "Warning")) or name in {"Unit", "TypeVar", "cast"}:
            return
        self._expression(node.func, function)
        if name == "range" and node.args:
            stop = node.args[min(1, len(node.args) - 1)]
            self._replace("index", function, stop, f"({self._text(stop)}) - 1")
        for argument in node.args:
            self._expression(argument, function)
        for keyword in node.keywords:
            if keyword.arg not in self._looks:
                self._expression(keyword.value, function)

    def _constant(self, node: ast.Constant, function: str) -> None:
        value = node.value
        if isinstance(value, bool):
            self._replace("constant", function, node, str(not value))
        elif isinstance(value, int):
            self._replace("constant", function, node, str(value + 1))
        elif isinstance(value, float):
            self._replace("constant", function, node, repr(2.0 * value or 1.0))

    def _arithmetic(self, node: ast.BinOp, function: str) -> None:
        sides = (node.left, node.right)
        of_texts = any(isinstance(side, ast.JoinedStr | ast.List | ast.Tuple) for side in sides)
        of_texts |= any(isinstance(s, ast.Constant) and isinstance(s.value, str) for s in sides)
        of_types = isinstance(node.op, ast.BitOr) and any(map(_is_a_type, sides))
        old, new = _ARITHMETIC.get(type(node.op), ("", ""))
        if old and not of_texts and not of_types:
            span = (self._end(node.left), self._start(node.right))
            self._operator("arithmetic", function, span, re.escape(old), new)

    def _comparisons(self, node: ast.Compare, function: str) -> None:
        left = node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            old, new = _COMPARISONS[type(operator)]
            span = (self._end(left), self._start(right))
            compared = (self._text(left), self._text(right))
            if type(operator) in _REVERSED and not any(map(_WHOLE.search, compared)):
                self._operator("tie", function, span, old, new)
                new = _REVERSED[type(operator)]
            self._operator("comparison", function, span, old, new)
            left = right

    def _negate(self, test: ast.expr, function: str) -> None:
        self._replace("condition", function, test, f"not ({self._text(test)})")

    def _index(self, node: ast.expr, function: str) -> None:
        match node:
            case ast.Tuple():
                for element in node.elts:
                    self._index(element, function)
            case ast.Slice():
                for bound in (node.lower, node.upper):
                    if bound is not None:
                        self._index(bound, function)
                self._expression(node.step, function)
            case ast.Constant(value=int(value)) if not isinstance(value, bool):
                self._replace("index", function, node, str(value + 1))
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int(value))):
                self._replace("index", function, node, f"-{value + 1}")
            case ast.BinOp():
                self._replace("index", function, node, f"({self._text(node)}) + 1")
                self._expression(node, function)
            case ast.Name() if len(node.id) == 1 or node.id in {"index", "start", "stop"}:
                self._replace("index", function, node, f"{node.id} + 1")
            case _:
                self._expression(node, function)


def _is_left_alone(statement: ast.stmt) -> bool:
    match statement:
        case ast.Import() | ast.ImportFrom() | ast.Assert() | ast.Pass() | ast.Global():
            return True
        case ast.Nonlocal() | ast.Expr(value=ast.Constant()):
            return True
        case ast.Expr(value=ast.Call(func=called)):
            return bool(_SPOKEN.search(ast.unparse(called)))
        case ast.If(test=test):
            return bool(re.search(r"TYPE_CHECKING|__name__", ast.unparse(test)))
        case ast.Assign(targets=[ast.Name(id=name)]):
            return name.startswith("__") or name in {"_log", "log", "logger"}
    return False


def _is_ellipsis(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _is_a_type(node: ast.expr) -> bool:
    if isinstance(node, ast.Name):
        return node.id in _TYPES or node.id[0].isupper()
    return isinstance(node, ast.Constant) and node.value is None


def _own_nodes(function: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a function, without those of the functions inside it."""
    for child in ast.iter_child_nodes(function):
        if not isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield child
            yield from _own_nodes(child)
