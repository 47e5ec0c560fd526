"""The shared library: where it is, its contexts, and its errors as exceptions."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Callable, Optional

from ._cffi import ffi


def _open_library() -> Any:
    """libdea.so: DEA_LIBRARY, that of the build or installation of this package, or the system's."""
    names = [os.environ.get("DEA_LIBRARY")]
    try:
        from ._where import LIBRARY  # written by the build
        names.append(LIBRARY)
    except ImportError:
        pass
    names.append("libdea.so.0")
    reasons = []
    for name in names:
        if name:
            try:  # stays loaded: objects may be freed after this module
                return ffi.dlopen(name, ffi.RTLD_NOW | ffi.RTLD_NODELETE)
            except OSError as error:
                reasons.append(str(error))
    raise ImportError("libdea.so.0 cannot be loaded; DEA_LIBRARY may name it: " + "; ".join(reasons))


lib = _open_library()


def text(pointer: Any) -> str:
    return ffi.string(pointer).decode("utf-8", "replace")


def version() -> str:
    """Version of the library that is loaded."""
    return text(lib.dea_version())


@dataclass(frozen=True)
class Finding:
    """What was found in a design or during a run; line and column count from 1, 0: not known."""

    severity: str  # "note", "warning", "error"
    text: str
    file: str
    line: int
    column: int

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.line else ""
        return f"{place}{self.severity}: {self.text}"


class DeaError(Exception):
    """A call of the library failed.

    status: "DEA_E_DESIGN"; findings: all of them, with their place; trace: functions of the library
    that it went through; result: what was computed before, or None.
    """

    def __init__(self, status: str, message: str, findings: list[Finding], trace: str):
        self.status, self.message, self.findings, self.trace = status, message, findings, trace
        self.result: Any = None
        errors = [str(f) for f in findings if f.severity == "error"]
        super().__init__("\n".join([message] + errors))


class DesignError(DeaError, ValueError):
    """The design has errors: see findings."""


class ArgumentError(DeaError, LookupError):
    """A name is not known, or an argument is out of range."""


class UnsupportedError(DeaError, NotImplementedError):
    """This build, or this model, cannot do that."""


class FileError(DeaError, OSError):
    """A file could not be read or written, or a program is missing."""


class SolverError(DeaError, ArithmeticError):
    """No convergence, or no equilibrium at that load; result has what came before."""


_KINDS = {
    "DEA_E_DESIGN": DesignError,
    "DEA_E_ARGUMENT": ArgumentError,
    "DEA_E_UNSUPPORTED": UnsupportedError,
    "DEA_E_IO": FileError,
    "DEA_E_TOOL": FileError,
    "DEA_E_DOMAIN": SolverError,
    "DEA_E_NOT_CONVERGED": SolverError,
    "DEA_E_NO_EQUILIBRIUM": SolverError,
    "DEA_E_SLACK": SolverError,
    "DEA_E_INVERTED": SolverError,
}
_SEVERITIES = ("note", "warning", "error")

Progress = Callable[[str, int, int], None]


class _Life:
    """Frees a context when it and all that was made with it are gone, in whatever order Python
    throws them away."""

    def __init__(self, pointer: Any):
        self.pointer, self.users, self._free = pointer, 0, lib.dea_context_free

    def leave(self) -> None:
        self.users -= 1
        if self.users == 0:
            self._free(self.pointer)


class Handle:
    """An object of the library, freed with this one."""

    def __init__(self, pointer: Any, free: Optional[Callable[[Any], None]], life: _Life):
        self.pointer, self._free, self._life = pointer, free, life
        life.users += 1

    def __del__(self) -> None:
        if self._free is not None:
            self._free(self.pointer)
        self._life.leave()


class Context:
    """A context of the library."""

    def __init__(self, progress: Optional[Progress] = None,
                 note: Optional[Callable[[str, str], None]] = None):
        self._progress, self._note = progress, note
        self._raised: Optional[BaseException] = None  # by a callback
        options = ffi.new("dea_context_options *")
        options.size = ffi.sizeof("dea_context_options")
        # an exception in a callback, Ctrl-C above all, ends the run: the next question says stop
        self._kept = [
            ffi.callback("void(void *, char *, size_t, size_t)", self._on_progress,
                         onerror=self._on_error),
            ffi.callback("int(void *)", self._on_interrupt, error=1, onerror=self._on_error),
            ffi.callback("void(void *, enum dea_severity, char *)", self._on_note,
                         onerror=self._on_error),
        ]
        options.interrupt = self._kept[1]
        if progress is not None:
            options.progress = self._kept[0]
        if note is not None:
            options.note = self._kept[2]
        out = ffi.new("dea_context **")
        if lib.dea_context_new(options, out) != lib.DEA_OK:
            raise MemoryError("no memory for a context of libdea")
        self._life = _Life(out[0])
        self._own = Handle(out[0], None, self._life)
        self.handle = out[0]

    def _on_progress(self, _user: Any, what: Any, done: int, total: int) -> None:
        assert self._progress is not None
        self._progress(text(what), done, total)

    def _on_note(self, _user: Any, severity: int, said: Any) -> None:
        assert self._note is not None
        self._note(_SEVERITIES[severity], text(said))

    def _on_interrupt(self, _user: Any) -> int:
        return 0 if self._raised is None else 1  # Python runs its signal handlers before this line

    def _on_error(self, _kind: Any, error: BaseException, _trace: Any) -> None:
        if self._raised is None:
            self._raised = error

    def findings(self) -> list[Finding]:
        found, index = [], 0
        while True:
            f = lib.dea_finding_at(self.handle, index)
            if f == ffi.NULL:
                return found
            found.append(Finding(_SEVERITIES[f.severity], text(f.text), text(f.file), f.line,
                                 f.column))
            index += 1

    def error(self, status: int) -> BaseException:
        """The exception of a call that failed, or the one that a callback raised."""
        raised, self._raised = self._raised, None
        if raised is not None:
            return raised
        name = text(lib.dea_error_name(status))
        message = text(lib.dea_error_message(self.handle)) or text(lib.dea_error_meaning(status))
        if name == "DEA_E_MEMORY":
            return MemoryError(message)
        kind = _KINDS.get(name, DeaError)
        return kind(name, message, self.findings(), text(lib.dea_error_trace(self.handle)))

    def check(self, status: int) -> None:
        if status != lib.DEA_OK:
            raise self.error(status)
        raised, self._raised = self._raised, None
        if raised is not None:  # by a callback, after the last question
            raise raised

    def own(self, pointer: Any, free: Callable[[Any], None]) -> Handle:
        return Handle(pointer, free, self._life)
