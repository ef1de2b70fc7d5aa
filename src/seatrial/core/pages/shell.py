"""A page in its shell: the templates of a package on the shell's own, and the policy of what the page may run.

The Content-Security-Policy names styles and scripts by their SHA-256 (W3C, Content Security Policy Level 3, 2.3.1).
"""

import base64
import hashlib
import re
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path

from jinja2 import BytecodeCache, ChoiceLoader, Environment, PackageLoader, StrictUndefined
from jinja2.bccache import Bucket

from seatrial.core.figures.svg_text import night_rules
from seatrial.numerics.kernels.cache import read_entry, source_digest, write_entry

_COLOUR = re.compile(r'(?:fill|stroke)="(#[0-9a-f]{6}(?:[0-9a-f]{2})?)"')
_STYLE, _SCRIPT = re.compile(r"<style>(.*?)</style>", re.DOTALL), re.compile(r"<script>(.*?)</script>", re.DOTALL)
# places of the shell that are filled once the page's text is known
_POLICY, _NIGHT_RULES = "POLICY-OF-THIS-PAGE", "/* NIGHT-RULES */"


class CompiledTemplates(BytecodeCache):
    """Keeps templates compiled to Python, a third of the time that a report takes.

    By their text, this package's code, and the versions of Jinja and Python.
    """

    def _name(self, bucket: Bucket) -> str:
        facts = f"{bucket.key} {bucket.checksum} {version('jinja2')} {sys.version}".encode()
        return f"template-{hashlib.sha256(facts + source_digest(Path(__file__).parent)).hexdigest()[:24]}.bin"

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give the bucket its code, where it was compiled before."""
        content = read_entry(self._name(bucket))
        if content is not None:
            bucket.bytecode_from_string(content)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep the code of the bucket."""
        write_entry(self._name(bucket), bucket.bytecode_to_string())


@cache
def environment(package: str) -> Environment:
    """Return the templates of a package and the shell's, with everything escaped by default."""
    return Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("seatrial.core.pages")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        bytecode_cache=CompiledTemplates(),
    )


def with_policy(text: str) -> str:
    """Return a rendered page with the colours of its figures for dark screens and its policy."""
    text = text.replace(_NIGHT_RULES, night_rules(_COLOUR.findall(text)), 1)
    return text.replace(_POLICY, policy(text), 1)


def policy(text: str) -> str:
    """Return the policy of a page: nothing but its own styles and scripts may take effect."""
    styles, scripts = (" ".join(map(_digest, pattern.findall(text))) for pattern in (_STYLE, _SCRIPT))
    script = scripts or "'none'"
    return (
        f"default-src 'none'; img-src data:; style-src {styles}; script-src {script}; connect-src 'none'; "
        "base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
