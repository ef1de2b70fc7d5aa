"""The page answers this machine only, on two paths, and says nothing JSON cannot hold."""

import http.client
import json
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.onboard.fabricated import faulty_counts, heave_pitch, mmg

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.onboard import page as module
from seatrial.onboard.page import Page, content_security_policy, html


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Iterator[Page]:
    monkeypatch.setattr(module, "POLL_INTERVAL_S", 0.005)
    with Page(0, title="trial.toml") as made:
        yield made


def asked(
    page: Page, path: str, *, method: str = "GET", headers: dict[str, str] | None = None
) -> tuple[http.client.HTTPResponse, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=5)
    connection.request(method, path, headers=headers or {})
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer, body


def state(page: Page, since: int = -1) -> dict[str, Any]:
    answer, body = asked(page, f"/state.json?since={since}")
    assert answer.status == 200 and answer.getheader("Content-Type") == "application/json"
    return json.loads(body, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


def test_the_page_is_whole_and_may_do_nothing_but_ask_its_own_address(page: Page) -> None:
    answer, body = asked(page, "/")
    text = body.decode()
    assert answer.status == 200 and text == html()
    allowed = answer.getheader("Content-Security-Policy") or ""
    assert allowed == content_security_policy() and "default-src 'none'" in allowed and "unsafe" not in allowed
    assert "src=" not in text and "@import" not in text and "url(" not in text
    assert [word for word in text.split() if "://" in word] == ['"http://www.w3.org/2000/svg",']


def test_before_anything_came_there_is_a_state(page: Page) -> None:
    shows = state(page)
    assert (
        shows["snapshot"] is None and shows["points"] == [] and shows["title"] == "trial.toml" and not shows["is_over"]
    )


def test_state_has_the_newest_and_only_the_points_asked_for(page: Page) -> None:
    snapshots = list(heave_pitch(100.0))
    for snapshot in snapshots[:150]:
        page.show(snapshot, faulty_counts())
    whole = state(page)
    assert len(whole["points"]) == 150
    assert whole["points"][0][2:4] == [[pytest.approx(v) for v in snapshots[0].value], [None] * 8]
    assert whole["points"][-1][3] == pytest.approx(1.96 * snapshots[149].standard_error)
    for snapshot in snapshots[150:]:
        page.show(snapshot, faulty_counts())
    later = state(page, whole["points"][-1][0])
    assert [p[0] for p in later["points"]] == list(range(150, 201)) and later["epoch"] == whole["epoch"]
    assert later["snapshot"]["phase"] == "recursive" and later["snapshot"]["rows"][0]["name"] == "a33"
    assert ["wrong checksum", 4] in later["snapshot"]["faults"]


def test_angles_are_degrees_in_plots_as_in_the_table(page: Page) -> None:
    snapshot = list(mmg(100.0))[-1]
    page.show(snapshot, SampleCounts())
    shows = state(page)
    assert shows["points"][0][2][-1] == pytest.approx(np.degrees(snapshot.value[-1]))
    assert shows["points"][0][4][-1] == pytest.approx(np.degrees(snapshot.noise["psi"]))
    assert shows["snapshot"]["rows"][-1]["unit"] == "deg" and shows["snapshot"]["noise"][-1]["unit"] == "deg"


def test_other_coefficients_and_another_program_are_another_epoch(page: Page) -> None:
    page.show(next(iter(heave_pitch(0.0))), SampleCounts())
    first = state(page)["epoch"]
    page.show(next(iter(mmg(0.0))), SampleCounts())
    second = state(page)
    with Page(0) as other:
        third = state(other)["epoch"]
    assert len({first, second["epoch"], third}) == 3 and len(second["points"]) == 1


def test_the_same_again_is_no_news(page: Page) -> None:
    snapshot = next(iter(heave_pitch(0.0)))
    page.show(snapshot, SampleCounts())
    for counts, is_news in ((SampleCounts(), False), (SampleCounts(late=1), True)):
        page._updated_at -= 60.0
        page.show(snapshot, counts)
        assert (state(page)["age"] < 30.0) is is_news and len(state(page)["points"]) == 1


def test_the_end_of_the_stream_is_said(page: Page) -> None:
    page.end("end of trial.csv")
    assert (state(page)["is_over"], state(page)["reason"]) == (True, "end of trial.csv")


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "localhost:1", "", "[::1]:80"])
def test_another_host_is_refused(page: Page, host: str) -> None:
    for path in ("/", "/state.json"):
        answer, body = asked(page, path, headers={"Host": host})
        assert answer.status == 403 and b"{" not in body


def test_a_host_given_twice_or_not_at_all_is_refused(page: Page) -> None:
    good = f"Host: 127.0.0.1:{page.port}\r\n"
    for hosts, status in ((good, b"200"), (good + good, b"403"), (good + "Host: evil\r\n", b"403"), ("", b"403")):
        with socket.create_connection(("127.0.0.1", page.port), timeout=5) as made:
            made.sendall(f"GET /state.json HTTP/1.0\r\n{hosts}\r\n".encode())
            assert made.recv(100).split()[1] == status


def test_localhost_is_this_machine(page: Page) -> None:
    assert asked(page, "/", headers={"Host": f"localhost:{page.port}"})[0].status == 200


def test_other_sites_may_not_read_the_state(page: Page) -> None:
    for site, status in (("cross-site", 403), ("same-site", 403), ("same-origin", 200), ("none", 200)):
        answer, _ = asked(page, "/state.json", headers={"Sec-Fetch-Site": site})
        assert answer.status == status and answer.getheader("Access-Control-Allow-Origin") is None


@pytest.mark.parametrize("method", ["HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"])
def test_get_only(page: Page, method: str) -> None:
    answer, _ = asked(page, "/state.json", method=method)
    assert answer.status == 405 and answer.getheader("Allow") == "GET"


@pytest.mark.parametrize(
    "path", ["/page.py", "/../page.py", "/%2e%2e/etc/passwd", "/state.json/", "/index.html", "http://evil/"]
)
def test_no_other_path_and_no_files(page: Page, path: str) -> None:
    assert asked(page, path, headers={"Host": f"127.0.0.1:{page.port}"})[0].status == 404


@pytest.mark.parametrize("query", ["since=x", "since=1e9", "since=--1", "since=" + "9" * 40, "since=%00"])
def test_a_number_that_is_none_is_refused(page: Page, query: str) -> None:
    assert asked(page, f"/state.json?{query}")[0].status == 400


def test_only_the_loopback_address_listens(page: Page) -> None:
    assert page._server is not None and page._server.socket.getsockname() == ("127.0.0.1", page.port)
    assert page.address == f"http://127.0.0.1:{page.port}/"


def test_a_port_in_use_or_none_at_all_is_said_in_one_sentence(page: Page) -> None:
    with pytest.raises(InputError, match=rf"^port {page.port} of the page is in use .*; give another"), Page(page.port):
        pass
    for port in (-1, 70000):
        with pytest.raises(InputError, match=f"there is no port {port} for the page"), Page(port):
            pass


def test_a_port_is_free_again_after_the_page() -> None:
    with Page(0) as first:
        asked(first, "/")
    with Page(first.port) as second:
        assert second.port == first.port
    assert not [thread for thread in threading.enumerate() if thread.name == "page" and thread.is_alive()]


def test_a_page_nobody_looks_at_ends_at_once() -> None:
    begun = time.monotonic()
    with Page(0) as page:
        page.show(next(iter(heave_pitch(0.0))), SampleCounts())
        page.end()
    assert time.monotonic() - begun < 1.0


def test_a_visitor_who_goes_away_or_says_nothing_disturbs_nobody(page: Page, capfd: pytest.CaptureFixture[str]) -> None:
    silent = socket.create_connection(("127.0.0.1", page.port))
    with socket.create_connection(("127.0.0.1", page.port)) as rude:
        rude.sendall(b"\x00\xff garbage\r\n\r\n")
    assert state(page)["snapshot"] is None
    silent.close()
    assert capfd.readouterr().err == ""


def test_many_ask_while_the_estimate_goes_on(page: Page) -> None:
    failed: list[BaseException] = []

    def visit() -> None:
        try:
            for _ in range(10):
                got = [p[0] for p in state(page)["points"]]
                assert got == sorted(got)
        except BaseException as error:
            failed.append(error)

    visitors = [threading.Thread(target=visit) for _ in range(4)]
    for visitor in visitors:
        visitor.start()
    for snapshot in heave_pitch(200.0):
        page.show(snapshot, SampleCounts())
    for visitor in visitors:
        visitor.join()
    assert failed == []


def test_control_characters_and_infinities_do_not_reach_the_page(page: Page) -> None:
    snapshot = replace(list(heave_pitch(10.0))[-1], time=np.inf, noise={"z": np.nan}, unidentified=("a33",))
    page.show(snapshot, replace(faulty_counts(), last_problem="\x1b[2J\x00 sentence"))
    shows = state(page)["snapshot"]
    assert shows["last"] == "·[2J· sentence" and shows["time"] == "–" and shows["noise"][0]["rms"] == "–"
