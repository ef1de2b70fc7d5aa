"""What was worked out once about equations, as JSON in the compile cache: a warm process neither repeats it nor needs
SymPy for it."""

import hashlib
import json
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from seatrial.numerics.kernels.cache import discard_entry, read_entry, source_digest, write_entry

_HERE = Path(__file__).parent


def entry_key(key: Sequence[object], sources: Sequence[Path] = ()) -> str:
    """Return 24 hexadecimal digits for a question and all source text that decides its answer.

    key: values whose `repr` is the same in every process. sources: folders of Python files, besides this one.
    """
    digests = [source_digest(folder) for folder in (_HERE, *sources)]
    facts = repr((tuple(key), version("sympy"))).encode()
    return hashlib.sha256(b"\0".join((facts, *digests))).hexdigest()[:24]


def stored(kind: str, key: Sequence[object], work_out: Callable[[], Any], sources: Sequence[Path] = ()) -> Any:
    """Return a JSON value from the compile cache, or work it out and keep it there.

    kind: first part of the entry's name. key, sources: as for `entry_key`.
    """
    name = f"{kind}-{entry_key(key, sources)}.json"
    content = read_entry(name)
    if content is not None:
        try:
            return json.loads(content)
        except ValueError as error:
            discard_entry(name, str(error))
    content = json.dumps(work_out()).encode()
    write_entry(name, content)
    return json.loads(content)
