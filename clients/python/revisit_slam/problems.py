"""Errors of the client: refusals of the server, and a server that cannot be reached."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import httpx
import msgspec

from .errors import RevisitError
from .models import Fault, Problem

__all__ = ["ProblemError", "RevisitError", "ServerUnreachable", "found", "problem_of", "retry_after"]

Answer = TypeVar("Answer")


class ServerUnreachable(RevisitError):
    """No answer came, after all retries."""


class ProblemError(RevisitError):
    """A refusal of the server, with its `code`, every fault in `errors`, and the whole `problem`."""

    def __init__(self, problem: Problem, retry_after_s: float | None = None) -> None:
        self.problem = problem
        self.retry_after_s = retry_after_s
        faults = "; ".join(filter(None, (_line(fault, problem.detail) for fault in problem.errors)))
        super().__init__(f"{problem.status} {problem.code}: {problem.detail}" + (f" ({faults})" if faults else ""))

    @property
    def status(self) -> int:
        """HTTP status."""
        return self.problem.status

    @property
    def code(self) -> str:
        """Name of the problem, such as `not_found`."""
        return self.problem.code

    @property
    def errors(self) -> list[Fault]:
        """Every fault of the request: pointer, detail, got and limit."""
        return self.problem.errors


def _line(fault: Fault, told: str) -> str:
    # A single fault's sentence is the detail already.
    sentence = None if fault.detail in told else f"{fault.pointer}: {fault.detail}"
    got = None if fault.got is None else f"got {fault.got}"
    limit = None if fault.limit is None else f"limit {fault.limit}"
    return ", ".join(part for part in (sentence, got, limit) if part is not None)


def problem_of(response: httpx.Response) -> ProblemError:
    """Return the problem of an answer >= 400; a proxy's answer without one becomes one with code `http_<status>`."""
    try:
        problem = msgspec.json.decode(response.content, type=Problem)
    except msgspec.DecodeError:
        status = response.status_code
        detail = response.text[:200] or response.reason_phrase
        problem = Problem(
            type="about:blank", title=response.reason_phrase, status=status, detail=detail, code=f"http_{status}",
            request_id=response.headers.get("x-request-id", ""), errors=[],
        )  # fmt: skip
    return ProblemError(problem, retry_after(response))


def found(ask: Callable[[str], Answer], id: str) -> Answer | None:
    """Return the answer to a question about an id; None where the server has no such thing."""
    try:
        return ask(id)
    except ProblemError as problem:
        if problem.status == 404:
            return None
        raise


def retry_after(response: httpx.Response) -> float | None:
    """Return the seconds of `retry-after`, if it has any."""
    try:
        return max(float(response.headers["retry-after"]), 0.0)
    except (KeyError, ValueError):
        return None
