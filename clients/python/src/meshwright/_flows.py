"""What a client asks, in which order, without saying how: each flow yields requests and is sent their answers.

The two clients differ only in how they carry requests, so they share these.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from .contact_pattern import ContactPattern
from .force_table import ForceTable
from .look_up import LookUpTable
from .problem import ProblemError
from .results import Job, Results
from .study import StudyTable

Json = dict[str, Any]
Submission = Mapping[str, Any]
Report = Callable[[int, int], None]
T = TypeVar("T")

# The service answers such a request when the job has changed, or after so many seconds.
_WAIT = {"prefer": "wait=2"}
_ENDED = ("successful", "failed", "dismissed")


@dataclass(frozen=True)
class Call:
    """A request, or with `pause` a wait in seconds before it; with `until_made` one for a file that may come later (202)."""

    method: str
    path: str
    body: Mapping[str, Any] | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    pause: float = 0.0
    as_text: bool = False
    until_made: bool = False


Flow = Generator[Call, Any, T]


def get(path: str) -> Flow[Any]:
    return (yield Call("GET", path))


def post(path: str, body: Mapping[str, Any] | None = None) -> Flow[Any]:
    return (yield Call("POST", path, body))


def look_up_table(job_id: str, torque: float | None) -> Flow[LookUpTable]:
    query = "" if torque is None else f"?torque={torque}"
    return LookUpTable.parse((yield Call("GET", f"/v1/jobs/{job_id}/results/look-up-table.csv{query}", as_text=True)))


def force_table(job_id: str) -> Flow[ForceTable]:
    return ForceTable.parse((yield Call("GET", f"/v1/jobs/{job_id}/results/force-table.txt", as_text=True)))


def fields(job_id: str, torque: float | None, mesh_position: float | None) -> Flow[str]:
    asked = {"torque": torque, "mesh_position": mesh_position}
    query = "&".join(f"{name}={value}" for name, value in asked.items() if value is not None)
    text: str = yield Call("GET", f"/v1/jobs/{job_id}/results/fields.vtu?{query}", as_text=True, until_made=True)
    return text


def contact_pattern(job_id: str, torque: float | None) -> Flow[ContactPattern]:
    query = "" if torque is None else f"?torque={torque}"
    return ContactPattern((yield Call("GET", f"/v1/jobs/{job_id}/results/contact-pattern.json{query}", until_made=True)))


def preview(submission: Submission) -> Flow[Results]:
    return Results((yield from post("/v1/preview", submission)))


def results(job_id: str, between: bool = False) -> Flow[Results]:
    query = "?between=true" if between else ""
    return Results((yield from get(f"/v1/jobs/{job_id}/results{query}")))


def solve(submission: Submission, report: Report) -> Flow[Results]:
    job: Json = yield from post("/v1/jobs", submission)
    while job["status"] not in _ENDED:
        report(job["positions_done"], job["positions_total"])
        job = yield Call("GET", f"/v1/jobs/{job['id']}", headers=_WAIT)
    report(job["positions_done"], job["positions_total"])
    if job["status"] != "successful":
        raise ProblemError(job.get("problem") or {"code": job["status"], "detail": f"the job was {job['status']}"})
    found = yield from results(job["id"])
    found.job = Job(job)
    return found


def study(document: Mapping[str, Any], report: Report) -> Flow[StudyTable]:
    state: Json = yield from post("/v1/studies", document)
    pause = 0.1
    while state["status"] not in _ENDED:
        report(state["done"], state["total"])
        state = yield Call("GET", f"/v1/studies/{state['id']}", pause=pause)
        pause = min(2 * pause, 2.0)
    report(state["done"], state["total"])
    path = f"/v1/studies/{state['id']}/results"
    population: Json | None = None
    if document.get("population") is not None:
        population = yield from get(f"{path}/population")
    search: Json | None = state.get("search")
    best: Json | None = None
    if search is not None and search["best"] is not None:
        best = yield from get(f"/v1/studies/{state['id']}/best")
    quantities: Json = yield from get("/v1/quantities")
    return StudyTable((yield from get(path)), population, search, best, quantities["items"])


def example(name: str) -> Flow[Json]:
    found: Json = yield from get("/v1/examples")
    for each in found["items"]:
        if each["name"] == name:
            submission: Json = each["submission"]
            return submission
    raise KeyError(f"there is no example {name}; there are {', '.join(each['name'] for each in found['items'])}")
