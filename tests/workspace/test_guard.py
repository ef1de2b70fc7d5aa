"""Only this machine's page reaches the workspace, with small requests completed in time, and files below its folder."""

import asyncio
import http.client
import json
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.workspace.logs import Opened, opened, write_trial

from seatrial.workspace import guard
from seatrial.workspace.events import EventStream


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("guarded") / "inner"
    folder.mkdir()
    (folder.parent / "secret.csv").write_text("t,a\n0,1\n", encoding="utf-8")
    write_trial(folder)
    return folder


@pytest.fixture(scope="module")
def workspace(folder: Path) -> Iterator[Opened]:
    with opened(folder) as served:
        yield served


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"Cookie": ""}, 401),
        ({"Cookie": "seatrial-1=x"}, 401),
        ({"Host": "evil.example"}, 403),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": ""}, 403),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
    ],
)
def test_who_is_answered(workspace: Opened, headers: dict[str, str], status: int) -> None:
    assert workspace.request("POST", "/api/state", b"{}", headers)[0] == status


def test_the_token_is_changed_for_a_cookie_that_scripts_cannot_read(workspace: Opened) -> None:
    path = workspace.address.partition(str(workspace.port))[2]
    status, _, headers = workspace.request("GET", path, headers={"Cookie": "", "Origin": ""})
    assert status == 303 and headers["location"] == "/"
    assert "HttpOnly" in headers["set-cookie"] and "SameSite=Strict" in headers["set-cookie"]
    assert workspace.request("GET", "/?token=other", headers={"Cookie": "", "Origin": ""})[0] == 401


def test_the_page_may_run_its_own_files_only(workspace: Opened) -> None:
    status, body, headers = workspace.request("GET", "/")
    policy = headers["content-security-policy"]
    assert status == 200 and "default-src 'none'" in policy and "unsafe" not in policy
    assert b"<script>" not in body and b" on" not in body.replace(b" only", b"") and b"style=" not in body


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE"])
def test_other_methods_are_refused(workspace: Opened, method: str) -> None:
    assert workspace.request(method, "/api/state")[0] == 405


@pytest.mark.parametrize(
    "path", ["/static/../server.py", "/static/%2e%2e/server.py", "/report/../../secret.csv", "/report/trial.toml", "/x"]
)
def test_no_other_file_is_served(workspace: Opened, path: str) -> None:
    assert workspace.request("GET", path)[0] == 404


@pytest.mark.parametrize("name", ["../secret.csv", "/etc/hostname", "..", "a\x00b"])
def test_no_file_outside_the_folder_is_named(workspace: Opened, name: str) -> None:
    status, answer = workspace.ask("candidates", {"log": name})
    assert status == 422 and ("outside" in answer["error"] or "no name" in answer["error"])


@pytest.mark.parametrize(
    ("place", "value"), [(("data", "folder"), ".."), (("records", 0, "files"), ["../secret.csv"]),
                         (("data", "folder"), "${HOME}")]
)  # fmt: skip
def test_no_edit_leads_outside_the_folder(workspace: Opened, place: tuple, value: object) -> None:
    _, state = workspace.ask("state")
    edit = {"kind": "set", "place": place, "value": value, "version": state["version"]}
    status, answer = workspace.ask("edit", edit)
    assert status == 422 and ("outside" in answer["error"] or "variable" in answer["error"])
    assert workspace.ask("state")[1]["text"] == state["text"]


def test_a_long_request_is_refused(workspace: Opened) -> None:
    body = b" " * (guard.LARGEST_REQUEST + 1)
    assert workspace.request("POST", "/api/state", body)[0] == 413


@pytest.mark.parametrize("name", [".hidden.csv", "log_1.csv", "other.toml", "a%5Cb.csv", "%2e%2e%2fx.csv"])
def test_an_upload_replaces_nothing_and_hides_nothing(workspace: Opened, folder: Path, name: str) -> None:
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    assert workspace.request("POST", f"/api/upload/{name}", b"t,a\n")[0] in (404, 422)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_an_upload_that_does_not_say_its_length_is_bounded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "LARGEST_UPLOAD", 1000)
    with opened(folder) as served:
        connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=30)
        headers = {"Cookie": served.cookie, "Origin": served.origin}
        parts = (b"0,1\n" * 100 for _ in range(10))
        connection.request("POST", "/api/upload/long.csv", parts, headers, encode_chunked=True)
        assert connection.getresponse().status == 413
        connection.close()
    assert not [path for path in folder.iterdir() if "long.csv" in path.name]


def test_an_upload_is_written_whole(workspace: Opened, folder: Path) -> None:
    content = b"t,a\n" + b"0,1\n" * 10_000
    assert workspace.request("POST", "/api/upload/new.csv", content)[0] == 200
    assert (folder / "new.csv").read_bytes() == content
    (folder / "new.csv").unlink()


def test_no_answer_shows_the_programs_inside(workspace: Opened) -> None:
    for body in (b"[1]", b"{", b'{"kind": "set"}', b'{"kind": "no such"}', b'{"block": []}'):
        for name in ("edit", "series", "simulate", "gains"):
            status, answer, _ = workspace.request("POST", f"/api/{name}", body)
            assert status in (409, 422) and "Traceback" not in json.loads(answer)["error"]


def test_a_client_that_trickles_is_dropped(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "REQUEST_TIMEOUT_S", 1.0)
    with opened(folder) as served, socket.create_connection(("127.0.0.1", served.port)) as slow:
        slow.settimeout(0.1)
        start, text = time.monotonic(), b"POST /api/state HTTP/1.1\r\nHost: " + b"x" * 1000
        dropped = None
        for byte in text:
            try:
                slow.sendall(bytes([byte]))
                if slow.recv(1) == b"":
                    dropped = time.monotonic() - start
                    break
            except TimeoutError:
                continue
            except OSError:
                dropped = time.monotonic() - start
                break
        assert dropped is not None and 0.9 < dropped < 10.0
        assert served.ask("state")[0] == 200


def test_a_page_that_reads_nothing_is_let_go() -> None:
    async def overrun() -> list[str]:
        stream = EventStream()
        listening = stream.listen()
        first = await anext(listening)
        for k in range(400):
            stream.publish("changed", {"version": str(k)})
        await asyncio.sleep(0.05)
        return [first, *[text async for text in listening]]

    texts = asyncio.run(overrun())
    assert texts[0].startswith("event: hello") and 1 < len(texts) < 300
