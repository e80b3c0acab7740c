"""Refusals and failures, as the service tells them (RFC 9457)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class FieldError:
    """What is wrong with one field: `pointer` says where, `nearest` the nearest value that would do, in the field's unit."""

    pointer: str
    code: str
    detail: str
    nearest: float | None = None


class ProblemError(Exception):
    """The service refused a request, or a job failed. `code` is stable; `errors` name the fields."""

    def __init__(self, problem: dict[str, Any]) -> None:
        self.problem = problem
        self.code: str = problem.get("code", "unknown")
        self.status: int = problem.get("status", 0)
        self.errors = [
            FieldError(each["pointer"], each["code"], each["detail"], each.get("nearest"))
            for each in problem.get("errors") or []
        ]
        details = [error.detail for error in self.errors] or [problem.get("detail", "no reason was given")]
        super().__init__(" ".join(details))
