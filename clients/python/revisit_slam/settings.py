"""What both clients are made with: the server's address, the proxy on the way to it, and times."""

from __future__ import annotations

import re
from contextlib import suppress
from importlib.util import find_spec
from ipaddress import ip_address, ip_network
from typing import Any
from urllib.request import getproxies

import httpx

from .errors import RevisitError

DEFAULT_URL = "http://127.0.0.1:7878"
TIMEOUT_S = 30.0
# An export begins once the server has looked through the map's corrections.
EXPORT_SILENCE_S = 300.0
# The server sends a comment on an idle stream more often than this.
EVENTS_SILENCE_S = 60.0
# To them there is no proxy.
THIS_MACHINE = "localhost,127.0.0.0/8,::1,0.0.0.0,::"


def http_settings(url: str, key: str | None, timeout_s: float) -> dict[str, Any]:
    """Return the arguments of an httpx client; without a key no header is sent."""
    address = httpx.URL(address_of(url))
    headers = {"authorization": f"Bearer {key.strip()}"} if key else {}
    # By itself httpx would fail at any proxy of the environment, also at one that is not on the way to this server.
    found: dict[str, Any] = {"trust_env": False, "proxy": proxy_to(address)}
    found |= {"base_url": address, "headers": headers, "timeout": httpx.Timeout(timeout_s)}
    if address.scheme == "https":
        try:
            found["verify"] = httpx.create_ssl_context()
        except OSError as error:
            raise RevisitError(f"what SSL_CERT_FILE or SSL_CERT_DIR names cannot be read: {error}") from error
    return found


def address_of(told: str) -> str:
    """Return a server's address as a person writes it: without a scheme it is http's; a path stays."""
    text = str(told).strip().rstrip("/")
    try:
        url = httpx.URL(text if "://" in text else f"http://{text}")
        url.host.encode("idna")  # As it is looked up.
        # What is written as `http:/HOST`, or is only a port, has no other host than these.
        is_host = re.fullmatch(r"(?!https?$|\d+$)[\w.:-]+", url.host)
        good = is_host and url.scheme in ("http", "https") and (url.port or 0) < 1 << 16
    except (httpx.InvalidURL, ValueError):
        good = False
    if not good or url.query or url.fragment:
        raise RevisitError(f"{str(told)!r} is no address of a server, such as {DEFAULT_URL} or https://HOST/PATH")
    return str(url)


def proxy_to(address: httpx.URL) -> httpx.Proxy | None:
    """Return the environment's proxy on the way to a server; none where the server is this machine, or NO_PROXY names it."""
    proxies = getproxies()
    kind = next((kind for kind in (address.scheme, "all") if proxies.get(kind)), None)
    if kind is None or _is_named(address, f"{THIS_MACHINE},{proxies.get('no', '')}"):
        return None
    told, lacks = proxies[kind], "it is no http://HOST:PORT, https:// or socks5://"
    try:
        proxy = httpx.Proxy(told if "://" in told else f"http://{told}")
        needs_socks = proxy.url.scheme.startswith("socks") and find_spec("socksio") is None
        lacks = "it needs `pip install 'httpx[socks]'`" if needs_socks else "" if proxy.url.host else lacks
    except (httpx.InvalidURL, ValueError):
        pass
    if lacks:
        # Not the name and the password that it may have.
        told = re.sub(r"[^/]*@", "", told)
        raise RevisitError(f"{kind.upper()}_PROXY={told}: {lacks}; with NO_PROXY={address.host} the server is asked without it")
    return proxy


def _is_named(address: httpx.URL, names: str) -> bool:
    """Whether NO_PROXY's names have a server: `*`, a host, a domain around it, an address or a network, each also with a port."""
    port = f":{address.port or {'http': 80, 'https': 443}[address.scheme]}"
    for name in re.split(r"[,\s]+", names.lower()):
        host = name.rpartition("://")[2].removesuffix(port).strip("[]")
        domain = host.lstrip("*.")
        if host == "*" or (domain and f".{address.host}".endswith(f".{domain}")):
            return True
        with suppress(ValueError):
            if ip_address(address.host) in ip_network(host, strict=False):
                return True
    return False
