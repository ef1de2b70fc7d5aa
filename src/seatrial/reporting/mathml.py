"""LaTeX of formulas as MathML, which browsers draw without any script; long sums may break at their signs.

Knows what SymPy and the equations' own symbols write: fractions, roots, scripts, primes, fences, functions, cases.
"""

import html
import re
from collections.abc import Callable

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)
_LETTERS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "varepsilon": "ε", "zeta": "ζ", "eta": "η",
    "theta": "θ", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "phi": "φ", "varphi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Lambda": "Λ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω", "infty": "∞", "ell": "ℓ", "nabla": "∇",
}  # fmt: skip
_OPERATORS = {
    "cdot": "·", "times": "×", "leq": "≤", "geq": "≥", "le": "≤", "ge": "≥", "neq": "≠", "ne": "≠", "wedge": "∧",
    "vee": "∨", "pm": "±",
}  # fmt: skip
_FENCES = {
    r"\{": "{", r"\}": "}", ".": "", r"\lvert": "|", r"\rvert": "|", r"\lfloor": "⌊", r"\rfloor": "⌋",
    r"\lceil": "⌈", r"\rceil": "⌉", r"\|": "‖",
}  # fmt: skip
_ACCENTS = {"dot": "˙", "ddot": "¨", "bar": "¯", "hat": "^", "tilde": "~"}
_TEXT_COMMANDS = {"mathrm", "operatorname", "text", "mathit", "mathbf"}
_SPACES = {r"\,", r"\:", r"\;", r"\ ", r"\quad", r"\!"}

Pieces = list[str]


def pieces(latex: str) -> Pieces:
    """Return the formula as MathML elements between which a line may break; unreadable LaTeX as plain text."""
    try:
        return [f'<math displaystyle="true">{piece}</math>' for piece in _Reader(latex).row(lambda _: False)]
    except (IndexError, StopIteration):
        return [f"<code>{html.escape(latex)}</code>"]


def inline(latex: str) -> str:
    """Return the formula as one MathML element."""
    return "".join(pieces(latex)).replace('</math><math displaystyle="true">', "")


def _mrow(parts: Pieces) -> str:
    body = "".join(parts)
    return f"<mrow>{body}</mrow>"


def _appended(before: Pieces, after: Pieces) -> Pieces:
    return [*before[:-1], before[-1] + after[0], *after[1:]]


def _accented(body: str, accent: str) -> str:
    """The accent over the letter itself where an index hangs on it."""
    indexed = re.fullmatch(r"<mrow><msub>(<mi>[^<]*</mi>)(.*)</msub></mrow>", body)
    if indexed:
        return f"<msub><mover>{indexed[1]}<mo>{accent}</mo></mover>{indexed[2]}</msub>"
    return f"<mover>{body}<mo>{accent}</mo></mover>"


class _Reader:
    """Reads tokens from left to right; every method returns pieces of MathML."""

    def __init__(self, latex: str) -> None:
        self.tokens: list[str] = _TOKEN.findall(latex.strip())
        self.position = 0

    def row(self, is_end: Callable[[str], bool]) -> Pieces:
        pieces_so_far: Pieces = [""]
        spaced = False
        while self.position < len(self.tokens) and not is_end(self.tokens[self.position]):
            token = self.tokens[self.position]
            if token.isspace():
                self.position += 1
                spaced = pieces_so_far[-1] != "" and not pieces_so_far[-1].endswith("</mo>")
                continue
            if token in ("+", "-"):
                self.position += 1
                sign = "+" if token == "+" else "−"
                if pieces_so_far[-1] and not pieces_so_far[-1].endswith("=</mo>"):
                    pieces_so_far = [*pieces_so_far, f'<mo form="infix">{sign}</mo>']
                else:
                    pieces_so_far = _appended(pieces_so_far, [f"<mo>{sign}</mo>"])
            else:
                part = self.scripted()
                space = '<mspace width="0.17em"></mspace>' if spaced and not part[0].startswith("<mo") else ""
                pieces_so_far = _appended(pieces_so_far, [space + part[0], *part[1:]])
            spaced = False
        return pieces_so_far

    def scripted(self) -> Pieces:
        """Return an atom with its primes, exponents, indices."""
        base = self.atom()
        primes, upper, lower = "", "", ""
        while self.position < len(self.tokens) and self.tokens[self.position] in ("^", "_", "'"):
            token = self.tokens[self.position]
            self.position += 1
            if token == "'":
                primes += '<mo lspace="0.05em" rspace="0">′</mo>'
            elif token == "^":
                upper = _mrow(self.argument())
            else:
                lower = _mrow(self.argument())
        if not (primes or upper or lower):
            return base
        body = "".join(base) + primes
        body = body if body.count("<") == 2 else f"<mrow>{body}</mrow>"
        if upper and lower:
            return [f"<msubsup>{body}{lower}{upper}</msubsup>"]
        return [f"<msup>{body}{upper}</msup>" if upper else f"<msub>{body}{lower}</msub>" if lower else body]

    def argument(self) -> Pieces:
        """Return the next group in braces, or the next atom."""
        while self.tokens[self.position].isspace():
            self.position += 1
        return self.atom()

    def atom(self) -> Pieces:
        token = self.tokens[self.position]
        self.position += 1
        if token == "{":
            inner = self.row(lambda t: t == "}")
            self.expect("}")
            return inner
        if token.startswith("\\"):
            return self.command(token)
        if token[0].isdigit():
            return [f"<mn>{token}</mn>"]
        if token.isalpha():
            return [f"<mi>{html.escape(token)}</mi>"]
        return [f'<mo stretchy="false">{html.escape(token)}</mo>']

    def command(self, token: str) -> Pieces:
        name = token[1:]
        if name in _LETTERS:
            return [f"<mi>{_LETTERS[name]}</mi>"]
        if name in _OPERATORS:
            return [f"<mo>{_OPERATORS[name]}</mo>"]
        if name in ("frac", "dfrac", "tfrac"):
            return [f"<mfrac>{_mrow(self.argument())}{_mrow(self.argument())}</mfrac>"]
        if name == "sqrt":
            return [f"<msqrt>{_mrow(self.argument())}</msqrt>"]
        if name in _ACCENTS:
            return [_accented(_mrow(self.argument()), _ACCENTS[name])]
        if name in _TEXT_COMMANDS:
            return [f'<mi mathvariant="normal">{self.word()}</mi>']
        if name == "left":
            return self.fenced()
        if name == "begin":
            return self.cases()
        if token in _SPACES:
            return ['<mspace width="0.3em"></mspace>']
        if token in _FENCES:
            return [f'<mo stretchy="false">{_FENCES[token]}</mo>']
        return [f"<mi>{html.escape(name)}</mi>"]

    def expect(self, token: str) -> None:
        """Step over a token that must be there; IndexError where the formula ends before it."""
        if self.tokens[self.position] != token:
            raise IndexError(token)
        self.position += 1

    def word(self) -> str:
        """Return the letters of the next group, as they stand."""
        self.position += 1
        start = self.position
        while self.tokens[self.position] != "}":
            self.position += 1
        self.position += 1
        letters = [_LETTERS.get(t[1:], t) for t in self.tokens[start : self.position - 1]]
        return html.escape("".join(letters)).replace("\\", "")

    def fenced(self) -> Pieces:
        r"""Read from after \left to after \right and its fence."""
        opening = self.fence()
        inner = self.row(lambda t: t == r"\right")
        self.expect(r"\right")
        closing = self.fence()
        enclosed = _appended(_appended([opening], inner), [closing])
        return enclosed if "|" not in opening else [_mrow(enclosed)]

    def fence(self) -> str:
        token = self.tokens[self.position]
        self.position += 1
        text = html.escape(_FENCES.get(token, token))
        return f'<mo stretchy="true" fence="true">{text}</mo>' if text else ""

    def cases(self) -> Pieces:
        r"""Read a table of rows ended by \\ and columns by &, from after \begin to after \end{…}."""
        self.word()
        rows, cells = [], []
        while True:
            cells.append(_mrow(self.row(lambda t: t in ("&", r"\\", r"\end"))))
            ended = self.tokens[self.position]
            self.position += 1
            if ended != "&":
                rows.append("<mtr>" + "".join(f"<mtd>{c}</mtd>" for c in cells) + "</mtr>")
                cells = []
            if ended == r"\end":
                self.word()
                return ['<mrow><mo stretchy="true">{</mo><mtable>' + "".join(rows) + "</mtable></mrow>"]
