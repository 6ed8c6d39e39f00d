"""What goes wrong, and where."""

from __future__ import annotations

from typing import TypeVar

_E = TypeVar("_E", bound="Error")


class Error(ValueError):
    """Anything that this package refuses. The text says all of it; the attributes are for programs."""

    #: The file as it was named.
    file: str | None = None
    #: Its line, counted from 1.
    line: int | None = None
    #: The key, column or argument.
    key: str | None = None

    @classmethod
    def at(
        cls: type[_E],
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
    ) -> _E:
        error = cls(message)
        error.file, error.line, error.key = file, line, key
        return error


class InputError(Error):
    """A file or an argument that cannot be used."""


class MissingFileError(InputError, FileNotFoundError):
    """A file that is not there."""


class RunError(Error):
    """A run that did not reach its end."""
