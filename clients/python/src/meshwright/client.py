"""The clients: one that waits, one that is awaited."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Any, TypeVar

import httpx

from . import _flows
from ._flows import Call, Flow, Json, Report, Submission
from ._progress import reporter
from .contact_pattern import ContactPattern
from .force_table import ForceTable
from .look_up import LookUpTable
from .problem import ProblemError
from .results import Results
from .study import StudyTable

T = TypeVar("T")

_USUAL_URL = "http://127.0.0.1:8080"
# Longer than the service lets a request wait.
_TIMEOUT = 120.0
# So many times a request is sent again that the service was too busy for.
_TRIES = 5


def _settings(url: str | None, key: str | None, user: str | None) -> dict[str, Any]:
    key = key or os.environ.get("MESHWRIGHT_KEY")
    headers = {"authorization": f"Bearer {key}"} if key else {}
    if user:
        headers["meshwright-user"] = user
    return {"base_url": url or os.environ.get("MESHWRIGHT_URL", _USUAL_URL), "headers": headers, "timeout": _TIMEOUT}


def _unreachable(base_url: httpx.URL, error: httpx.ConnectError) -> httpx.ConnectError:
    """The same error, with the address that nobody answers at."""
    detail = f"no service answers at {base_url} ({error}); url or MESHWRIGHT_URL says where it is"
    return httpx.ConnectError(detail, request=error.request)


def _answer(call: Call, response: httpx.Response) -> Any:
    if response.is_success:
        return response.text if call.as_text else response.json()
    try:
        problem = response.json()
    except ValueError:
        problem = {"status": response.status_code, "code": "unknown", "detail": response.text[:200]}
    raise ProblemError(problem)


def _pause_before_another_try(call: Call, response: httpx.Response, busy: int) -> float | None:
    """Seconds to wait where a file is not made yet, or the service was `busy` so many times; None where another try makes no sense."""
    is_made_later = response.status_code == 202 and call.until_made
    if not is_made_later and (not _is_busy(response) or busy > _TRIES):
        return None
    try:
        return float(response.headers.get("retry-after", "1"))
    except ValueError:
        return 1.0


def _is_busy(response: httpx.Response) -> bool:
    return response.status_code in (429, 503)


class Client:
    """Calls that wait for their answer.

    `url` is `MESHWRIGHT_URL` or the service on this machine, `key` is `MESHWRIGHT_KEY` or none. `user` is the user of the key's client on whose behalf
    the calls come: users take turns, and jobs say who submitted them.
    """

    def __init__(self, url: str | None = None, key: str | None = None, user: str | None = None) -> None:
        self._http = httpx.Client(**_settings(url, key, user))

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        self._http.close()

    def solve(self, submission: Submission, progress: bool | Report = False) -> Results:
        """Submits a job and gives its results when it has ended."""
        return self._run(_flows.solve(submission, reporter(progress)))

    def preview(self, submission: Submission) -> Results:
        """The results at once; the service keeps nothing."""
        return self._run(_flows.preview(submission))

    def validate(self, submission: Submission) -> Json:
        """The submission with its defaults, the pair's geometry, warnings and an estimate."""
        return self._run(_flows.post("/v1/validate", submission))

    def outline(self, submission: Submission) -> Json:
        """The true profile of both gears, their holes, and the line of action."""
        return self._run(_flows.post("/v1/outline", submission))

    def submit(self, submission: Submission) -> Json:
        """A new job."""
        return self._run(_flows.post("/v1/jobs", submission))

    def job(self, job_id: str) -> Json:
        """How a job stands."""
        return self._run(_flows.get(f"/v1/jobs/{job_id}"))

    def cancel(self, job_id: str) -> Json:
        """Stops a job."""
        return self._run(_flows.post(f"/v1/jobs/{job_id}/cancel"))

    def results(self, job_id: str, between: bool = False) -> Results:
        """The results of a job that has ended; with the points between positions in the lists of its curves, if wanted."""
        return self._run(_flows.results(job_id, between))

    def look_up_table(self, job_id: str, torque: float | None = None) -> LookUpTable:
        """One curve over the angle in SI units, for rotor dynamics: the first, or that of a torque."""
        return self._run(_flows.look_up_table(job_id, torque))

    def force_table(self, job_id: str) -> ForceTable:
        """The force between the gears over angle and approach, of a job that was asked for its `force_table`."""
        return self._run(_flows.force_table(job_id))

    def fields(self, job_id: str, torque: float | None = None, mesh_position: float | None = None) -> str:
        """Displacements and stresses in both gears at a mesh position, as a VTU document for ParaView, PyVista or meshio."""
        return self._run(_flows.fields(job_id, torque, mesh_position))

    def contact_pattern(self, job_id: str, torque: float | None = None) -> ContactPattern:
        """How the flanks of a pair that was computed along its faces press each other, and the lines of contact that do."""
        return self._run(_flows.contact_pattern(job_id, torque))

    def study(self, document: Mapping[str, Any], progress: bool | Report = False) -> StudyTable:
        """Submits a study and gives its table when all designs have ended."""
        return self._run(_flows.study(document, reporter(progress)))

    def examples(self) -> list[Json]:
        """The submissions that ship with the service."""
        items: list[Json] = self._run(_flows.get("/v1/examples"))["items"]
        return items

    def quantities(self) -> list[Json]:
        """The numbers by which designs are told: their names, titles, units, and what a submission needs for them."""
        items: list[Json] = self._run(_flows.get("/v1/quantities"))["items"]
        return items

    def example(self, name: str) -> Json:
        """One of them."""
        return self._run(_flows.example(name))

    def _run(self, flow: Flow[T]) -> T:
        try:
            call = next(flow)
            while True:
                call = flow.send(self._send(call))
        except StopIteration as end:
            value: T = end.value
            return value

    def _send(self, call: Call) -> Any:
        time.sleep(call.pause)
        busy = 0
        while True:
            try:
                response = self._http.request(call.method, call.path, json=call.body, headers=dict(call.headers))
            except httpx.ConnectError as error:
                raise _unreachable(self._http.base_url, error) from error
            busy += _is_busy(response)
            pause = _pause_before_another_try(call, response, busy)
            if pause is None:
                return _answer(call, response)
            time.sleep(pause)


class AsyncClient:
    """The calls of `Client`, to be awaited."""

    def __init__(self, url: str | None = None, key: str | None = None, user: str | None = None) -> None:
        self._http = httpx.AsyncClient(**_settings(url, key, user))

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.close()

    async def close(self) -> None:
        await self._http.aclose()

    async def solve(self, submission: Submission, progress: bool | Report = False) -> Results:
        return await self._run(_flows.solve(submission, reporter(progress)))

    async def preview(self, submission: Submission) -> Results:
        return await self._run(_flows.preview(submission))

    async def validate(self, submission: Submission) -> Json:
        return await self._run(_flows.post("/v1/validate", submission))

    async def outline(self, submission: Submission) -> Json:
        return await self._run(_flows.post("/v1/outline", submission))

    async def submit(self, submission: Submission) -> Json:
        return await self._run(_flows.post("/v1/jobs", submission))

    async def job(self, job_id: str) -> Json:
        return await self._run(_flows.get(f"/v1/jobs/{job_id}"))

    async def cancel(self, job_id: str) -> Json:
        return await self._run(_flows.post(f"/v1/jobs/{job_id}/cancel"))

    async def results(self, job_id: str, between: bool = False) -> Results:
        return await self._run(_flows.results(job_id, between))

    async def look_up_table(self, job_id: str, torque: float | None = None) -> LookUpTable:
        return await self._run(_flows.look_up_table(job_id, torque))

    async def force_table(self, job_id: str) -> ForceTable:
        return await self._run(_flows.force_table(job_id))

    async def fields(self, job_id: str, torque: float | None = None, mesh_position: float | None = None) -> str:
        return await self._run(_flows.fields(job_id, torque, mesh_position))

    async def contact_pattern(self, job_id: str, torque: float | None = None) -> ContactPattern:
        return await self._run(_flows.contact_pattern(job_id, torque))

    async def study(self, document: Mapping[str, Any], progress: bool | Report = False) -> StudyTable:
        return await self._run(_flows.study(document, reporter(progress)))

    async def examples(self) -> list[Json]:
        items: list[Json] = (await self._run(_flows.get("/v1/examples")))["items"]
        return items

    async def quantities(self) -> list[Json]:
        items: list[Json] = (await self._run(_flows.get("/v1/quantities")))["items"]
        return items

    async def example(self, name: str) -> Json:
        return await self._run(_flows.example(name))

    async def _run(self, flow: Flow[T]) -> T:
        try:
            call = next(flow)
            while True:
                call = flow.send(await self._send(call))
        except StopIteration as end:
            value: T = end.value
            return value

    async def _send(self, call: Call) -> Any:
        await asyncio.sleep(call.pause)
        busy = 0
        while True:
            try:
                response = await self._http.request(call.method, call.path, json=call.body, headers=dict(call.headers))
            except httpx.ConnectError as error:
                raise _unreachable(self._http.base_url, error) from error
            busy += _is_busy(response)
            pause = _pause_before_another_try(call, response, busy)
            if pause is None:
                return _answer(call, response)
            await asyncio.sleep(pause)
