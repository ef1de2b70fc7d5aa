"""The workspace's server: Starlette on the loopback address, one page, its files, and the acts of a `Workspace`."""

import asyncio
import json
import secrets
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from http import HTTPStatus
from importlib.resources import files
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from seatrial.core.pages import shell
from seatrial.core.values import InputError
from seatrial.core.values.files import is_file
from seatrial.numerics.platform import reuses_addresses_safely
from seatrial.workspace import craft_view, gains_view, logs_view, results_view
from seatrial.workspace.folder import opened_trial
from seatrial.workspace.guard import DeadlineProtocol, Guard
from seatrial.workspace.trial_document import EditConflictError
from seatrial.workspace.workspace import Workspace

LOOPBACK = "127.0.0.1"
_TOKEN_BYTES = 24  # of the token; chosen: beyond guessing
_GRACE_S = 1  # s that open requests have when the workspace ends; chosen
_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_STATIC = files("seatrial.workspace") / "static"
_SHARED = {
    "uPlot.js": ("seatrial.reporting", "uPlot.iife.min.js"),
    "uPlot.css": ("seatrial.reporting", "uPlot.min.css"),
    "style.css": ("seatrial.core.pages", "style.css"),
    "dark.css": ("seatrial.core.pages", "dark.css"),
}
"""Files of the page that reports have, too: name -> package and file in its templates."""

Answer = Callable[[Request], Any]


def serve_workspace(path: Path, port: int = 0, opened: Callable[[str], None] = lambda _: None) -> None:
    """Serve the workspace of a trial file, a log or a folder until the process is interrupted.

    Args:
        path: what is opened; port: 0 takes a free one.
        opened: takes the address, with its token, once the page can be loaded.

    Raises:
        InputError: there is nothing of that name, or the port cannot be opened.
    """
    server = _Server(path, port)
    server.run(lambda: opened(server.address))


@contextmanager
def workspace_beside(path: Path, port: int = 0) -> Iterator[tuple[Workspace, str]]:
    """Serve the workspace in a thread while the body runs; yield it and its address, with its token.

    Arguments and errors as those of `serve_workspace`.
    """
    server, is_ready = _Server(path, port), threading.Event()
    thread = threading.Thread(target=server.run, args=(is_ready.set,), name="workspace", daemon=True)
    thread.start()
    is_ready.wait()
    try:
        yield server.workspace, server.address
    finally:
        server.stop()
        thread.join()


class _Server:
    """A workspace on a port of this machine, which is bound from the start on."""

    def __init__(self, path: Path, port: int) -> None:
        trial, named = opened_trial(path)
        self.workspace = Workspace(trial, named)
        self._bound = _bound_socket(port)
        port, token = self._bound.getsockname()[1], secrets.token_urlsafe(_TOKEN_BYTES)
        self.address = f"http://{LOOPBACK}:{port}/?token={token}"
        guarded = Guard(application(self.workspace), port, token)
        config = uvicorn.Config(
            guarded, http=DeadlineProtocol, ws="none", lifespan="off", log_level="critical", access_log=False,
            timeout_graceful_shutdown=_GRACE_S, server_header=False, date_header=False,
        )  # fmt: skip
        self._server = _Uvicorn(config)

    def run(self, started: Callable[[], None]) -> None:
        """Answer until it is stopped, or the process is interrupted; `started` is called once a page can be loaded."""
        try:
            asyncio.run(self._serve(started))
        finally:
            self.workspace.close()

    def stop(self) -> None:
        """End it, from any thread."""
        self._server.should_exit = True

    async def _serve(self, started: Callable[[], None]) -> None:
        server = self._server
        task, watch = asyncio.create_task(server.serve([self._bound])), asyncio.create_task(_watch_file(self.workspace))
        try:
            while not server.started and not task.done():
                await asyncio.sleep(0.01)  # s; a start takes some ten of them
            started()
            while not server.should_exit and not task.done():
                await asyncio.sleep(0.1)  # s; an end is noticed as soon
        finally:
            server.should_exit = True
            watch.cancel()
            self.workspace.events.close()
            await task


class _Uvicorn(uvicorn.Server):
    """A server that leaves signals alone: an interrupt reaches the task that serves, and ends it by an exception."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


async def _watch_file(workspace: Workspace) -> None:
    """Publish that another program has changed the trial file."""
    version = await run_in_threadpool(lambda: workspace.document.version)
    while True:
        await asyncio.sleep(1.0)  # s; chosen: as soon as one looks back at the page
        try:
            now = await run_in_threadpool(lambda: workspace.document.version)
        except InputError:
            continue
        if now != version:
            version = now
            workspace.events.publish("changed", {"version": now, "summary": ""})
            await run_in_threadpool(workspace.begin_check)


def _bound_socket(port: int) -> socket.socket:
    """A socket on the loopback address.

    Raises:
        InputError: the port is in use, or none.
    """
    bound = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if reuses_addresses_safely():
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((LOOPBACK, port))
    except (OSError, OverflowError) as error:
        bound.close()
        raise InputError(f"port {port} cannot be opened ({error}); give one from 1024 to 65535, or 0 for any") from None
    return bound


def application(workspace: Workspace) -> Starlette:
    """Return the routes of a workspace, to stand behind a `Guard`."""
    root = workspace.folder.root

    def view_of(view: Callable[[str, Path], dict[str, Any]]) -> Callable[[dict[str, Any]], dict[str, Any]]:
        return lambda _: view(workspace.document.text, workspace.document.path)

    def fit_folder(name: str) -> Path:
        return workspace.folder.file(f"{name}/{results_view.RESULT}").parent

    def model_of(request: dict[str, Any]) -> Path | None:
        fit = str(request.get("fit", ""))
        return workspace.folder.file(f"{fit}/{results_view.MODEL}") if fit else None

    def fits(_: dict[str, Any]) -> dict[str, Any]:
        views = []
        for folder in results_view.fit_folders(root):
            try:
                views.append(results_view.fit_view(root, folder))
            except InputError as error:
                name = folder.relative_to(root).as_posix()
                views.append({"name": name, "state": "failed", "message": str(error), "has_trial": False})
        return {"fits": views}

    def series(request: dict[str, Any]) -> dict[str, Any]:
        text, path = workspace.document.text, workspace.document.path
        return logs_view.series_view(text, path, int(request["block"]), str(request["log"]))

    def simulated(request: dict[str, Any]) -> dict[str, Any]:
        values = {str(name): float(value) for name, value in request.get("values", {}).items()}
        speed = request.get("speed")
        return results_view.simulated_view(
            fit_folder(str(request["fit"])), str(request["manoeuvre"]), values, None if speed is None else float(speed)
        )

    def loops(_: dict[str, Any]) -> dict[str, Any]:
        return {"loops": [path.relative_to(root).as_posix() for path in workspace.folder.loops]}

    def loop(request: dict[str, Any]) -> dict[str, Any]:
        return gains_view.loop_view(root, workspace.folder.file(str(request["loop"])), model_of(request))

    def gains(request: dict[str, Any]) -> dict[str, Any]:
        values = {str(name): float(value) for name, value in request["gains"].items()}
        return gains_view.gains_view(workspace.folder.file(str(request["loop"])), model_of(request), values)

    def autopilot(request: dict[str, Any]) -> dict[str, Any]:
        model = model_of(request)
        if model is None:
            raise InputError("an autopilot needs a fit; choose one")
        speed = request.get("speed")
        loop_file = gains_view.write_autopilot(root, "autopilot", model, None if speed is None else float(speed))
        return {"loop": loop_file.name}

    def candidates(request: dict[str, Any]) -> dict[str, Any]:
        return logs_view.candidates_view(
            _log_of(workspace, str(request["log"])), [str(text) for text in request.get("columns", ())]
        )

    def difference(request: dict[str, Any]) -> dict[str, Any]:
        change = workspace.document.changes_since(str(request.get("since", "")))
        return {"diff": [] if change is None else change.diff}

    asks = {
        "state": lambda _: workspace.state(), "logs": view_of(logs_view.logs_view), "series": series,
        "candidates": candidates, "craft": view_of(craft_view.craft_view), "check": lambda _: workspace.begin_check(),
        "fits": fits, "simulate": simulated, "loops": loops, "loop": loop, "gains": gains, "difference": difference,
        "onboard": lambda _: {} if workspace.followed is None else workspace.followed.view(),
    }  # fmt: skip
    acts = {
        "edit": workspace.edit, "undo": workspace.undo, "start-fit": workspace.start_fit,
        "start-tuning": workspace.start_tuning, "start-poster": workspace.start_poster,
        "start-follow": workspace.start_follow, "autopilot": autopilot,
        "stop": lambda request: workspace.jobs.stop(str(request["name"])),
    }  # fmt: skip
    routes = [
        *(Route(f"/api/{name}", _answering(work), methods=["POST"]) for name, work in (asks | acts).items()),
        Route("/api/events", lambda _: StreamingResponse(workspace.events.listen(), media_type="text/event-stream")),
        Route("/api/upload/{name:str}", _uploading(workspace), methods=["POST"]),
        Route("/", lambda _: _static("index.html")),
        Route("/static/{name:str}", lambda request: _static(request.path_params["name"])),
        Route("/report/{name:path}", _reporting(workspace)),
    ]
    return Starlette(routes=routes)


def _log_of(workspace: Workspace, name: str) -> Path:
    """A log below the folder, or one that the trial file names."""
    every = {str(path): path for path in workspace.own_logs()}
    return every[name] if name in every else workspace.folder.file(name)


def _answering(work: Callable[[dict[str, Any]], Any]) -> Callable[[Request], Any]:
    """An endpoint that gives a function the request's JSON and answers with its value; a sentence where it cannot."""

    async def answer(request: Request) -> Response:
        try:
            asked = json.loads(await request.body() or b"{}")
            if not isinstance(asked, dict):
                raise InputError("a request is a table of values")
            return JSONResponse(await run_in_threadpool(work, asked))
        except EditConflictError as error:
            return JSONResponse({"error": str(error), "version": error.version}, HTTPStatus.CONFLICT)
        except InputError as error:
            return JSONResponse({"error": " ".join(str(error).split())}, HTTPStatus.UNPROCESSABLE_ENTITY)
        except ClientDisconnect:
            return Response(status_code=HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse(
                {"error": f"the page asks for what this version does not know ({error}); reload it"},
                HTTPStatus.UNPROCESSABLE_ENTITY,
            )

    return answer


def _uploading(workspace: Workspace) -> Callable[[Request], Any]:
    async def answer(request: Request) -> Response:
        parts: AsyncIterator[bytes] = request.stream()
        try:
            path = await workspace.folder.receive(request.path_params["name"], parts)
        except ClientDisconnect:
            return JSONResponse(
                {"error": "the file is too large, or the page was closed"}, HTTPStatus.REQUEST_ENTITY_TOO_LARGE
            )
        except InputError as error:
            return JSONResponse({"error": str(error)}, HTTPStatus.UNPROCESSABLE_ENTITY)
        return JSONResponse({"name": path.name})

    return answer


def _static(name: str) -> Response:
    """A file of the page."""
    suffix = Path(name).suffix
    if name in _SHARED:
        package, file = _SHARED[name]
        text = (files(package) / "templates" / file).read_bytes()
        if name == "dark.css":
            text = b"@media (prefers-color-scheme: dark) {\n" + text + b"\n}\n"
    else:
        place = _STATIC / name
        if suffix not in _KINDS or "/" in name or not place.is_file():
            raise HTTPException(HTTPStatus.NOT_FOUND)
        text = place.read_bytes()
    return Response(text, media_type=_KINDS[suffix])


def _reporting(workspace: Workspace) -> Callable[[Request], Any]:
    """Reports and posters of result folders, in a sandbox: their scripts run, and reach nothing of the workspace."""

    async def answer(request: Request) -> Response:
        name = request.path_params["name"]
        try:
            path = workspace.folder.file(name)
        except InputError:
            raise HTTPException(HTTPStatus.NOT_FOUND) from None
        if path.name not in ("report.html", "poster.html") or not is_file(path):
            raise HTTPException(HTTPStatus.NOT_FOUND)
        text = await run_in_threadpool(path.read_text, "utf-8")
        policy = f"{shell.policy(text)}; frame-ancestors 'self'; sandbox allow-scripts allow-popups allow-modals"
        return Response(text, media_type="text/html", headers={"content-security-policy": policy})

    return answer
