"""Compiled templates come back from the cache, and a changed template does not."""

from jinja2 import DictLoader, Environment

from seatrial.core.pages.shell import CompiledTemplates
from seatrial.numerics.kernels.cache import cache_folder


def rendered(text: str) -> str:
    environment = Environment(loader=DictLoader({"page": text}), autoescape=True, bytecode_cache=CompiledTemplates())
    return environment.get_template("page").render(name="<roll>")


def test_a_template_is_compiled_once() -> None:
    assert rendered("Model {{ name }}") == "Model &lt;roll&gt;"
    before = set(cache_folder().glob("template-*"))
    assert rendered("Model {{ name }}") == "Model &lt;roll&gt;"
    assert set(cache_folder().glob("template-*")) == before
    assert rendered("Model: {{ name }}") == "Model: &lt;roll&gt;"
