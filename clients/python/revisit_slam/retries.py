"""Retry policy: which failures are tried again, and after how long."""

from __future__ import annotations

import random
from dataclasses import dataclass

import httpx

from .problems import ProblemError

RETRIED_STATUS = {408, 429, 502, 503, 504}


@dataclass(frozen=True)
class Retries:
    """Bounds of retrying; `total_s = 0` switches it off."""

    total_s: float = 30.0
    first_s: float = 0.1
    longest_s: float = 5.0

    def delay(self, attempt: int, spent_s: float, failure: Exception, repeatable: bool) -> float | None:
        """Return the seconds to wait before the next try, or None where there is none."""
        if isinstance(failure, ProblemError):
            if failure.status not in RETRIED_STATUS or (failure.status in (408, 502, 504) and not repeatable):
                return None
            wait = failure.retry_after_s if failure.retry_after_s is not None else self._backoff(attempt)
        elif isinstance(failure, (httpx.ConnectError, httpx.ConnectTimeout)) or (
            repeatable and isinstance(failure, httpx.TransportError)
        ):
            wait = self._backoff(attempt)
        else:
            return None
        return wait if self.total_s > 0 and spent_s + wait <= self.total_s else None

    def _backoff(self, attempt: int) -> float:
        # Half of it is random, so that a fleet does not come back in step.
        return min(self.first_s * 2**attempt, self.longest_s) * (0.5 + random.random() / 2)
