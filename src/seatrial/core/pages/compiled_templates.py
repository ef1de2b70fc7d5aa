"""Templates compiled to Python once and kept in the compile cache: a third of the time a report takes."""

import hashlib
import sys
from importlib.metadata import version
from pathlib import Path

from jinja2 import BytecodeCache
from jinja2.bccache import Bucket

from seatrial.numerics.kernels.cache import read_entry, source_digest, write_entry


class CompiledTemplates(BytecodeCache):
    """Keeps compiled templates, by their text, this package's code, and the versions of Jinja and Python."""

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
