"""Revisit: semantic place recognition for SLAM. The client, a sender that never blocks, and `revisit-play`."""

from .async_client import AsyncClient
from .client import Client
from .problems import ProblemError, RevisitError, ServerUnreachable
from .retries import Retries
from .sender import KeyframeSender, SenderStats
from .server import Server

__all__ = [
    "AsyncClient",
    "Client",
    "KeyframeSender",
    "ProblemError",
    "Retries",
    "RevisitError",
    "SenderStats",
    "Server",
    "ServerUnreachable",
]
__version__ = "0.1.0"
