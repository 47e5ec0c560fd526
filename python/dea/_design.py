"""Designs, and the lists of models and studies."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Union

from ._api import Context, ffi, lib, text

_ORIGINS = ("absent", "default", "given", "set")


@dataclass(frozen=True)
class Value:
    """A value of a design, as written and in SI."""

    key: str
    text: str
    si: float  # NAN for what is no number
    unit: str  # of si: "m"; "1" for a pure number, "" for what is none
    origin: str  # "absent", "default", "given", "set"
    line: int  # in the file; 0: not there
    column: int

    def __float__(self) -> float:
        if math.isnan(self.si):
            raise ValueError(f"{self.key} is no number: {self.text!r}")
        return self.si

    def __str__(self) -> str:
        return self.text


def _value(pointer: Any) -> Value:
    return Value(text(pointer.key), text(pointer.text), pointer.si, text(pointer.unit),
                 _ORIGINS[pointer.origin], pointer.line, pointer.column)


Setting = Union[str, int, float, bool, None, Value, list, tuple, Mapping]


def _yaml(value: Setting) -> str:
    """A value as it would stand in a design file."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_yaml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_yaml(item) for item in value) + "]"
    return str(value)


class Design:
    """An actuator: values with units under keys such as "film.thickness".

    design["film.thickness"] is a Value; design["film.thickness"] = "80 um" sets it, or raises a
    DesignError and changes nothing. Iterating gives the keys, defaults too.
    """

    def __init__(self, path: Union[str, os.PathLike]):
        """Reads a design file."""
        context, out = Context(), ffi.new("dea_design **")
        context.check(lib.dea_design_open(context.handle, os.fsencode(path), out))
        self._take(context, out[0])

    def _take(self, context: Context, pointer: Any) -> None:
        self._context = context
        self._handle = context.own(pointer, lib.dea_design_free)

    @classmethod
    def _of(cls, context: Context, pointer: Any) -> Design:
        design = cls.__new__(cls)
        design._take(context, pointer)
        return design

    @classmethod
    def parse(cls, yaml: str, name: str = "design") -> Design:
        """Reads a design from text; name stands for it in findings."""
        context, out = Context(), ffi.new("dea_design **")
        context.check(lib.dea_design_parse(context.handle, yaml.encode(), name.encode(), out))
        return cls._of(context, out[0])

    def copy(self) -> Design:
        context, out = Context(), ffi.new("dea_design **")
        context.check(lib.dea_design_copy(context.handle, self._handle.pointer, out))
        return self._of(context, out[0])

    def __getitem__(self, key: str) -> Value:
        out = ffi.new("dea_value **")
        self._context.check(
            lib.dea_design_get(self._context.handle, self._handle.pointer, key.encode(), out))
        return _value(out[0])

    def __setitem__(self, key: str, value: Setting) -> None:
        self.update({key: value})

    def __delitem__(self, key: str) -> None:
        """Takes the key away; its default holds then."""
        self.update({key: None})

    def update(self, values: Mapping[str, Setting]) -> None:
        """Sets several values at once, which may fit only together."""
        keys = [ffi.new("char[]", key.encode()) for key in values]
        texts = [ffi.new("char[]", _yaml(value).encode()) for value in values.values()]
        self._context.check(lib.dea_design_set_all(
            self._context.handle, self._handle.pointer, ffi.new("char *[]", keys),
            ffi.new("char *[]", texts), len(keys)))

    def values(self) -> Iterator[Value]:
        index = 0
        while True:
            pointer = lib.dea_design_value_at(self._handle.pointer, index)
            if pointer == ffi.NULL:
                return
            yield _value(pointer)
            index += 1

    def __iter__(self) -> Iterator[str]:
        return (value.key for value in self.values())

    def __contains__(self, key: object) -> bool:
        return any(value.key == key for value in self.values())

    def check(self) -> list:
        """Checks all that a run would; returns notes and warnings. DesignError with findings."""
        self._context.check(lib.dea_design_check(self._context.handle, self._handle.pointer))
        return self._context.findings()

    @property
    def yaml(self) -> str:
        """The design as YAML, with what was set."""
        out = ffi.new("char **")
        self._context.check(lib.dea_design_text(self._context.handle, self._handle.pointer, out))
        return text(out[0])

    def save(self, path: Union[str, os.PathLike]) -> None:
        self._context.check(
            lib.dea_design_write(self._context.handle, self._handle.pointer, os.fsencode(path)))

    @property
    def svg(self) -> str:
        """The actuator from above and cut along a fibre."""
        out = ffi.new("char **")
        self._context.check(lib.dea_design_svg(self._context.handle, self._handle.pointer, out))
        return text(out[0])

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<dea.Design {str(self['title']) or 'without title'!r}>"


@dataclass(frozen=True)
class Model:
    """A model; abilities: "path", "profile", "indent", "modes", "respond", "fields", "time",
    "refine"; layout_abilities: those of devices made of plies."""

    name: str
    title: str
    abilities: frozenset
    available: bool
    layout_abilities: frozenset


@dataclass(frozen=True)
class Study:
    """A study; needs: keys of the design without which it cannot run."""

    name: str
    needs: str


_ABILITIES = ("path", "profile", "indent", "modes", "respond", "fields", "time", "refine")


def models() -> dict[str, Model]:
    """All models by name."""
    context, found = Context(), {}
    while True:
        info = lib.dea_model_at(context.handle, len(found))
        if info == ffi.NULL:
            return found
        can, layouts = (frozenset(a for a in _ABILITIES
                                  if bits & getattr(lib, "DEA_CAN_" + a.upper()))
                        for bits in (info.abilities, info.layout_abilities))
        found[text(info.name)] = Model(text(info.name), text(info.title), can,
                                       bool(info.available), layouts)


def studies() -> dict[str, Study]:
    """All studies by name, in the order in which they run."""
    context, found = Context(), {}
    while True:
        info = lib.dea_study_at(context.handle, len(found))
        if info == ffi.NULL:
            return found
        found[text(info.name)] = Study(text(info.name), text(info.needs))
