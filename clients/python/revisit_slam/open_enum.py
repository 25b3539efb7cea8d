"""Enumeration that accepts values of a newer server."""

from __future__ import annotations

from enum import Enum


class OpenEnum(str, Enum):
    """A string enumeration; a value that it does not know becomes a member that equals its text."""

    @classmethod
    def _missing_(cls, value: object) -> OpenEnum | None:
        if not isinstance(value, str):
            return None
        member = str.__new__(cls, value)
        member._name_ = value.upper()
        member._value_ = value
        return member

    def __str__(self) -> str:
        return str(self.value)

    @property
    def known(self) -> bool:
        """Whether this package knew the value when it was made."""
        return self.value in type(self)._value2member_map_
