"""What holds for every test of data: messages are ones that people read to their end."""

import re
from collections.abc import Iterator

import pytest

from seatrial.core.values import InputError

LONGEST_MESSAGE = 400  # letters of a sentence on bad input, without the folder of the test's files
_TEST_FOLDER = re.compile(r"\S*/pytest-of-\S*/")


@pytest.fixture(autouse=True)
def short_messages(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Fail where a message is too long, whether or not the test looks at it."""
    lengths: list[tuple[int, str]] = []
    make = InputError.__init__

    def noted(self: InputError, *arguments: object) -> None:
        text = _TEST_FOLDER.sub("", " ".join(map(str, arguments)))
        lengths.append((len(text), text))
        make(self, *arguments)

    monkeypatch.setattr(InputError, "__init__", noted)
    yield
    longest = max(lengths, default=(0, ""))
    assert longest[0] <= LONGEST_MESSAGE, f"a message of {longest[0]} letters: {longest[1]}"
