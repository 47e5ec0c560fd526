"""Runs, and what they leave: arrays, fields, figures."""

from __future__ import annotations

import html
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Callable, Optional, Union

import numpy as np

from ._design import Design
from ._api import Context, DeaError, Finding, Handle, ffi, lib, text

Path = Union[str, os.PathLike]


class Array(np.ndarray):
    """Numbers of a result, not copied: they lie in the library, which keeps them as long as this
    array or a part of it lives. Read only. What is computed of them is an ordinary array.

    name: "3d/sweep/voltage_V"; unit: SI, "1" for a pure number; meaning: one clause.
    """

    name: str
    unit: str
    meaning: str

    def __array_finalize__(self, parent: Any) -> None:
        for key in ("name", "unit", "meaning"):
            setattr(self, key, getattr(parent, key, ""))

    def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
        inputs = tuple(np.asarray(i) if isinstance(i, Array) else i for i in inputs)
        return getattr(ufunc, method)(*inputs, **kwargs)


class _Memory:
    """Memory of the library, which numpy takes as it is; keeps its owner alive."""

    def __init__(self, address: int, shape: tuple, kind: str, owner: Handle):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "data": (address, True), "shape": shape,
                                    "typestr": np.dtype(kind).str}


def _numbers(pointer: Any, shape: tuple, kind: str, owner: Handle) -> np.ndarray:
    """A read-only array over memory of the library."""
    if 0 in shape:
        return np.zeros(shape, kind)
    return np.asarray(_Memory(int(ffi.cast("uintptr_t", pointer)), shape, kind, owner))


def _array(pointer: Any, owner: Handle) -> Array:
    shape = tuple(pointer.shape[i] for i in range(pointer.rank))
    array = _numbers(pointer.data, shape, "f8", owner).view(Array)
    array.name, array.unit = text(pointer.name), text(pointer.unit)
    array.meaning = text(pointer.meaning)
    return array


class Svg(str):
    """A picture; a notebook shows it."""

    def save(self, path: Path) -> None:
        with open(path, "w", encoding="utf-8") as file:
            file.write(self)

    def _repr_svg_(self) -> str:
        return str(self)


@dataclass(frozen=True)
class Field:
    """A field on a mesh: values [points or cells, components]."""

    name: str
    values: Array
    of_cells: bool
    kind: str  # "values", "vector", "axis"


_KINDS = ("values", "vector", "axis")


class Mesh:
    """Points in the stretched flat film, cells, and fields by name ("displacement_m").

    fold: the whole is 2 fold mirrored copies of this part; 0: this is the whole.
    """

    def __init__(self, pointer: Any, owner: Handle):
        self.name, self.voltage_V = text(pointer.name), pointer.voltage_V
        self.fold, self.symmetry_angle_rad = pointer.fold, pointer.symmetry_angle_rad
        self.points = _numbers(pointer.points_m, (pointer.point_count, 3), "f8", owner)
        self._cells = []  # (order, order_z, nodes [count, nodes of a cell])
        for i in range(pointer.cells_count):
            cells = pointer.cells[i]
            nodes = _numbers(cells.nodes, (cells.count, cells.nodes_per_cell), "i4", owner)
            self._cells.append((cells.order, cells.order_z, nodes))
        self.fields = {}
        for i in range(pointer.field_count):
            field = pointer.fields[i]
            values = _array(field.array, owner)
            self.fields[values.name] = Field(values.name, values, bool(field.of_cells),
                                             _KINDS[field.kind])

    def _copied(self) -> Mesh:
        """This mesh, in memory of its own."""
        self.points = self.points.copy()
        self._cells = [(a, b, nodes.copy()) for a, b, nodes in self._cells]
        self.fields = {name: Field(name, f.values.copy(), f.of_cells, f.kind)
                       for name, f in self.fields.items()}
        return self

    def __getitem__(self, name: str) -> Array:
        """Values of a field."""
        if name not in self.fields:
            raise KeyError(f"there is no field '{name}'; there are: {', '.join(self.fields)}")
        return self.fields[name].values

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.fields)

    def linear(self) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Cells of order 1 in the order of VTK, elements of a higher order split at their nodes:
        {"quad": [n, 4], "hexahedron": [n, 8]}, and of each the element that it is a piece of."""
        found: dict[str, list] = {}
        first = 0
        for order, order_z, nodes in self._cells:
            grid = nodes.reshape(len(nodes), order_z + 1, order + 1, order + 1)  # [e, k, j, i]
            kind = "hexahedron" if order_z > 0 else "quad"
            elements = np.arange(first, first + len(nodes))
            first += len(nodes)
            for k in range(max(order_z, 1)):
                for j in range(order):
                    for i in range(order):
                        ring = [(j, i), (j, i + 1), (j + 1, i + 1), (j + 1, i)]
                        levels = (k, k + 1) if order_z > 0 else (0,)
                        piece = np.stack([grid[:, z, y, x] for z in levels for y, x in ring], 1)
                        found.setdefault(kind, []).append((piece, elements))
        cells = {kind: np.concatenate([p for p, _ in pieces]) for kind, pieces in found.items()}
        of = {kind: np.concatenate([e for _, e in pieces]) for kind, pieces in found.items()}
        return cells, of

    def to_meshio(self) -> Any:
        """A meshio.Mesh of linear cells with all fields."""
        import meshio

        cells, of = self.linear()
        points = {f.name: np.asarray(f.values) for f in self.fields.values() if not f.of_cells}
        data = {f.name: [np.asarray(f.values)[of[kind]] for kind in cells]
                for f in self.fields.values() if f.of_cells}
        return meshio.Mesh(np.asarray(self.points), list(cells.items()), point_data=points,
                           cell_data=data)

    def to_pyvista(self) -> Any:
        """A pyvista.UnstructuredGrid of linear cells with all fields."""
        import pyvista

        return pyvista.utilities.from_meshio(self.to_meshio())


class Result(Mapping):
    """What a run left: arrays by name, MODEL/STUDY/KEY (docs/api.md), for example
    result["3d/sweep/voltage_V"]."""

    def __init__(self, context: Context, pointer: Any, findings: Sequence[Finding] = ()):
        self._context = context
        self._handle = context.own(pointer, lib.dea_result_free)
        self.findings = list(findings)

    def __getitem__(self, name: str) -> Array:
        out = ffi.new("dea_array **")
        status = lib.dea_result_array(self._context.handle, self._handle.pointer, name.encode(), out)
        if status != lib.DEA_OK:
            error = str(self._context.error(status))
            if name in self.curves:
                first = next(key for key in self if key.startswith(name + "/"))
                error = f"'{name}' is a curve, whose arrays have names such as '{first}'"
            elif "did you mean" not in error:
                error += f"; there are those of: {', '.join(self.curves)}"
            raise KeyError(error) from None
        return _array(out[0], self._handle)

    def __iter__(self) -> Iterator[str]:
        index = 0
        while True:
            array = lib.dea_result_array_at(self._handle.pointer, index)
            if array == ffi.NULL:
                return
            yield text(array.name)
            index += 1

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def table(self, name: str) -> dict[str, Array]:
        """The points of a curve ("3d/sweep") or the rows of a profile as columns: for example for
        pandas.DataFrame."""
        columns = {key[len(name) + 1:]: self[key] for key in self
                   if key.startswith(name + "/") and "/" not in key[len(name) + 1:]}
        if not columns:
            raise KeyError(f"there is nothing in '{name}'; there are: {', '.join(self.curves)}")
        return columns

    @property
    def curves(self) -> list[str]:
        """Names of all that has points: "lumped/sweep", "lumped/path/pull_in", ..."""
        return list(dict.fromkeys(key.rpartition("/")[0] for key in self))

    def text(self, name: str) -> str:
        """A text: title, design, program, started, summary, "3d/sweep/stopped", ... (dea.h)."""
        out = ffi.new("char **")
        self._context.check(
            lib.dea_result_text(self._context.handle, self._handle.pointer, name.encode(), out))
        return text(out[0])

    def meshes(self) -> Iterator[str]:
        """Names of the meshes: "3d/surface/0004" is the film at point 4 of the sweep."""
        index = 0
        while True:
            mesh = lib.dea_result_mesh_at(self._handle.pointer, index)
            if mesh == ffi.NULL:
                return
            yield text(mesh.name)
            index += 1

    def mesh(self, name: str, whole: bool = True) -> Mesh:
        """The mesh of that name with its fields; whole: with all mirrored copies."""
        out = ffi.new("dea_mesh **")
        self._context.check(lib.dea_result_mesh(self._context.handle, self._handle.pointer, name.encode(),
                                                int(whole), out))
        return Mesh(out[0], self._handle)

    def figure(self, name: str = "") -> Svg:
        """A figure as SVG: "displacement", "stretch", "field", ...; "": the first there is."""
        out = ffi.new("char **")
        self._context.check(
            lib.dea_result_svg(self._context.handle, self._handle.pointer, name.encode(), out))
        return Svg(text(out[0]))

    def design(self) -> Design:
        """The design that was computed."""
        context, out = Context(), ffi.new("dea_design **")
        context.check(lib.dea_result_design(context.handle, self._handle.pointer, out))
        return Design._of(context, out[0])

    def save(self, path: Path) -> None:
        """Writes results.h5 to that path; dea.load reads it."""
        self._context.check(
            lib.dea_result_save(self._context.handle, self._handle.pointer, os.fsencode(path)))

    def write(self, folder: Path, replace: bool = False, figures: bool = True) -> None:
        """Writes a run folder: results.h5, tables, summary, figures (docs/results.md)."""
        options, _kept = _run_options(replace=replace, figures=figures)
        self._context.check(lib.dea_result_write(self._context.handle, self._handle.pointer,
                                                 os.fsencode(folder), options))

    def __repr__(self) -> str:
        return f"<dea.Result {self.text('title')!r}: {', '.join(self.curves[:6])}>"

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def _headline(self, curve: str) -> str:
        """The largest displacement at the last point of a curve."""
        columns = self.table(curve)
        moves = {k: abs(v[-1]) for k, v in columns.items()
                 if v.ndim == 1 and v.unit == "m" and np.isfinite(v[-1])}
        if not moves or "voltage_V" not in columns:
            return ""
        key = max(moves, key=lambda k: (k not in ("highest_z_m", "lowest_z_m"), moves[k],
                                        k.endswith("z_m")))
        return f"{key} = {columns[key][-1]:.4g} at {columns['voltage_V'][-1]:.4g} V"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(c)}</td><td>{len(next(iter(self.table(c).values())))}</td>"
            f"<td>{html.escape(self._headline(c))}</td></tr>" for c in self.curves if c.count("/") == 1)
        figure = ""
        for name in ("monitors", ""):  # the first there is, where nothing is monitored
            try:
                figure = figure or str(self.figure(name))
            except DeaError:
                pass
        return (f"<h4>{html.escape(self.text('title'))}</h4><table><tr><th>curve</th><th>points</th>"
                f"<th>last point</th></tr>{rows}</table>{figure}")


def _names(names: Union[str, Sequence[str], None], kept: list) -> tuple[Any, int]:
    chosen = [names] if isinstance(names, str) else list(names or [])
    strings = [ffi.new("char[]", name.encode()) for name in chosen]
    array = ffi.new("char *[]", strings)
    kept += strings + [array]
    return array, len(strings)


def _run_options(models=None, studies=None, folder=None, replace=False, resume=False,
                 figures=True) -> tuple[Any, list]:
    """Options, and what they point to."""
    kept: list = []
    options = ffi.new("dea_run_options *")
    options.size = ffi.sizeof("dea_run_options")
    options.models, options.model_count = _names(models, kept)
    options.studies, options.study_count = _names(studies, kept)
    if folder is not None:
        kept.append(ffi.new("char[]", os.fsencode(folder)))
        options.folder = kept[-1]
    options.replace, options.resume, options.no_figures = replace, resume, not figures
    return options, kept


def _print_progress(what: str, done: int, total: int) -> None:
    end = "\n" if done == total else ""
    print(f"\r{what} {done}/{total}", end=end, file=sys.stderr, flush=True)


def run(design: Design, models: Union[str, Sequence[str], None] = None,
        studies: Union[str, Sequence[str], None] = None, *, folder: Optional[Path] = None,
        replace: bool = False, resume: bool = False, figures: bool = True,
        progress: Union[bool, Callable[[str, int, int], None]] = False) -> Result:
    """Runs studies on a design with models, by default those that the design asks for.

    folder: run folder that is written as the run goes. progress: True for a line on stderr, or a
    function of what, done, total. Other threads of Python run meanwhile. A run that fails on the
    way, or is interrupted by Ctrl-C, raises an exception whose `result` has what was computed.
    """
    call = _print_progress if progress is True else progress or None
    context, out = Context(progress=call), ffi.new("dea_result **")
    options, _kept = _run_options(models, studies, folder, replace, resume, figures)
    status = lib.dea_run(context.handle, design._handle.pointer, options, out)
    findings = context.findings()
    result = Result(context, out[0], findings) if out[0] != ffi.NULL else None
    try:
        context.check(status)
    except BaseException as error:
        error.result = result  # type: ignore[attr-defined]
        raise
    assert result is not None
    return result


def load(path: Path) -> Result:
    """Reads results.h5, or the run folder that has it."""
    context, out = Context(), ffi.new("dea_result **")
    context.check(lib.dea_result_open(context.handle, os.fsencode(path), out))
    return Result(context, out[0], context.findings())


_SHAPES = {"sphere": "DEA_SPHERE", "flat": "DEA_FLAT_END", "cylinder": "DEA_LYING_CYLINDER"}


class Actuator:
    """One model of a design, a voltage at a time: actuator.solve(2e3); actuator["centre_z_m"]."""

    def __init__(self, design: Design, model: str):
        self._context, out = Context(), ffi.new("dea_actuator **")
        self._context.check(lib.dea_actuator_open(self._context.handle, design._handle.pointer,
                                                  model.encode(), out))
        self._handle = self._context.own(out[0], lib.dea_actuator_free)

    def solve(self, voltage_V: float) -> None:
        """Stable equilibrium, reached from the last one; SolverError when there is none."""
        self._context.check(
            lib.dea_actuator_solve(self._context.handle, self._handle.pointer, float(voltage_V)))

    def indent(self, depth_m: float, radius_m: float, shape: str = "sphere") -> None:
        """Brings a rigid indenter ("sphere", "flat", "cylinder") to a depth beyond touching."""
        self._context.check(lib.dea_actuator_indent(
            self._context.handle, self._handle.pointer, getattr(lib, _SHAPES[shape]), float(radius_m),
            float(depth_m)))

    def __getitem__(self, key: str) -> float:
        """A quantity of the last point by its key, NAN when the model has none."""
        out = ffi.new("double *")
        self._context.check(
            lib.dea_actuator_get(self._context.handle, self._handle.pointer, key.encode(), out))
        return out[0]

    def mesh(self) -> Mesh:
        """All fields in the volume at the last point: a copy."""
        out = ffi.new("dea_mesh **")
        self._context.check(lib.dea_actuator_mesh(self._context.handle, self._handle.pointer, out))
        return Mesh(out[0], self._handle)._copied()  # the library's own goes with the next call
