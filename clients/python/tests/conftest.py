"""A server of the real program, for all tests of a run."""

import itertools
from collections.abc import Iterator

import pytest

from revisit_slam import Client, Server

_names = itertools.count()


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    with Server() as running:
        yield running


@pytest.fixture
def client(server: Server) -> Iterator[Client]:
    with Client(server.url) as made:
        yield made


@pytest.fixture
def map_id(client: Client) -> str:
    name = f"test-{next(_names)}"
    client.put_map(name, {})
    return name
