"""A page may run what stands in it and nothing more, and fetch from where its policy says."""

import base64
import hashlib
import re

from seatrial.core.pages.shell import environment, policy, with_policy


def digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def test_the_policy_names_what_the_page_holds() -> None:
    text = "<style>a</style><script>b</script><script type='application/json'>{}</script>"
    allowed = policy(text)
    assert re.findall(r"'sha256-[^']*'", allowed) == [digest("a"), digest("b")]
    assert "default-src 'none'" in allowed and "connect-src 'none'" in allowed and "unsafe" not in allowed
    assert "script-src 'none'" in policy("<style>a</style>")


def test_a_page_gets_its_policy_and_the_colours_of_its_figures_for_the_dark() -> None:
    shell = environment("seatrial.core.pages").get_template("shell.html").render()
    text = with_policy(shell.replace("<body>", '<body><svg><path stroke="#222222"/></svg>'))
    assert "POLICY-OF-THIS-PAGE" not in text and policy(text) in text
    assert "[stroke='#222222']{stroke:#" in text and text.count("<style>") == 1
