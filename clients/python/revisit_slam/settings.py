"""What both clients are made with."""

from __future__ import annotations

from typing import Any

import httpx

from .retries import Retries

DEFAULT_URL = "http://127.0.0.1:7878"
TIMEOUT_S = 30.0
# An export begins once the server has looked through the map's corrections.
EXPORT_SILENCE_S = 300.0
# The server sends a comment on an idle stream more often than this.
EVENTS_SILENCE_S = 60.0


def http_settings(url: str, key: str | None, timeout_s: float) -> dict[str, Any]:
    """Return the arguments of an httpx client; without a key no header is sent."""
    headers = {"authorization": f"Bearer {key}"} if key else {}
    # The environment's proxies are left out for a server on this machine only.
    local = httpx.URL(url).host in ("127.0.0.1", "localhost", "::1")
    return {"base_url": url, "headers": headers, "timeout": httpx.Timeout(timeout_s), "trust_env": not local}


__all__ = ["DEFAULT_URL", "EVENTS_SILENCE_S", "EXPORT_SILENCE_S", "TIMEOUT_S", "Retries", "http_settings"]
