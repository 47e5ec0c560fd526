"""Solids: the 3D engine with a mesh of one's own, or a box."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np

from ._api import Context, ffi, lib, text
from ._result import Array, Mesh, Path, _array

Numbers = Union[Sequence[float], np.ndarray]
Components = Union[str, Sequence[str]]
Nodes = Union[Sequence[int], Sequence[bool], np.ndarray]

_AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Law:
    """A hyperelastic law; parameters in their order: "c1 [Pa]", ..."""

    name: str
    title: str
    parameters: tuple


def laws() -> dict[str, Law]:
    """All laws by name."""
    context, found = Context(), {}
    while True:
        info = lib.dea_law_at(context.handle, len(found))
        if info == ffi.NULL:
            return found
        parameters = tuple(text(info.parameters).split(", "))
        found[text(info.name)] = Law(text(info.name), text(info.title), parameters)


@dataclass(frozen=True)
class Part:
    """Material of a part of a solid, in SI.

    law: incompressible, with its parameters (dea.laws()); without one the part is compressible, of
    young_modulus_Pa and poisson_ratio (below 0.49). bulk_modulus_Pa: of the law's iteration to
    volume 1, 0: 100 times the shear modulus. pre_stretch: equibiaxial in x and y, of the law.
    permittivity: relative. electrode_gap_m: height that the voltage stands over; 0: not between
    electrodes. channel_above, channel_below: of these electrodes, from 1, or 0 for ground; both 0:
    channel 1 above ground.
    """

    law: Optional[str] = None
    parameters: Numbers = ()
    young_modulus_Pa: float = 0
    poisson_ratio: float = 0
    bulk_modulus_Pa: float = 0
    pre_stretch: float = 1
    permittivity: float = 0
    electrode_gap_m: float = 0
    density_kg_per_m3: float = 0
    channel_above: int = 0
    channel_below: int = 0


@dataclass(frozen=True)
class Fill:
    """A part in a ply of a plane mesh (0: the lowest): where it is in a group, a physical surface of
    the .msh file; None: everywhere."""

    ply: int
    group: Optional[str]
    part: int


@dataclass(frozen=True)
class Body:
    """Nodes that move as one, by a shift and a rotation vector about centre_m: those with
    low_m <= X <= high_m (None: everywhere), on, above and below a physical curve of the .msh file
    (None: all), with these numbers (rows of points_m, or True for each; None: all)."""

    centre_m: Numbers = (0, 0, 0)
    low_m: Optional[Numbers] = None
    high_m: Optional[Numbers] = None
    curve: Optional[str] = None
    nodes: Optional[Nodes] = None


@dataclass(frozen=True)
class Setting:
    """A tolerance or limit of the solvers; unit: also what a relative number is relative to."""

    name: str
    unit: str
    meaning: str
    value: float


def _doubles(values: Any, shape: tuple, kept: list, kind: str = "double") -> Any:
    """A pointer to numbers of that shape (-1: any), which `kept` keeps."""
    array = np.ascontiguousarray(values, np.float64 if kind == "double" else np.intc)
    if len(array.shape) != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape)):
        wanted = " x ".join("n" if n < 0 else str(n) for n in shape)
        raise ValueError(f"an array of {wanted} numbers is due, not one of shape {array.shape}")
    kept.append(array)
    return ffi.cast(f"{kind} *", array.ctypes.data)


def _nodes(nodes: Nodes, kept: list) -> tuple[Any, int]:
    """Numbers of nodes, of an array that has them or says True for them."""
    numbers = np.asarray(nodes)
    numbers = np.flatnonzero(numbers) if numbers.dtype == bool else numbers.ravel()
    return _doubles(numbers, (-1,), kept, "int"), len(numbers)


def _text(value: Optional[str], kept: list) -> Any:
    if value is None:
        return ffi.NULL
    kept.append(ffi.new("char[]", value.encode()))
    return kept[-1]


def _mask(components: Components, known: Sequence[str]) -> int:
    """Bits of "xz" or ["x", "rz"]."""
    mask = 0
    for name in components:
        if name not in known:
            raise ValueError(f"there is no component '{name}', only {', '.join(known)}")
        mask |= 1 << known.index(name)
    return mask


def _struct(kind: str, kept: list, **members: Any) -> Any:
    one = ffi.new(f"{kind} *")
    one.size = ffi.sizeof(kind)
    for name, value in members.items():
        setattr(one, name, value)
    kept.append(one)
    return one


def _pointers(kind: str, items: Sequence[Any], kept: list) -> Any:
    kept.append(ffi.new(f"{kind} *[]", list(items)))
    return kept[-1]


def _part(part: Part, kept: list) -> Any:
    numbers = {name: getattr(part, name) for name in (
        "young_modulus_Pa", "poisson_ratio", "bulk_modulus_Pa", "pre_stretch", "permittivity",
        "electrode_gap_m", "density_kg_per_m3", "channel_above", "channel_below")}
    return _struct("dea_part", kept, law=_text(part.law, kept),
                   parameters=_doubles(part.parameters, (-1,), kept),
                   parameter_count=len(part.parameters), **numbers)


def _body(body: Body, kept: list) -> Any:
    one = _struct("dea_body", kept, curve=_text(body.curve, kept), centre_m=list(body.centre_m))
    if body.low_m is not None or body.high_m is not None:
        one.low_m, one.high_m = _corners(body.low_m, body.high_m)
    if body.nodes is not None:
        one.nodes, one.node_count = _nodes(body.nodes, kept)
    return one


def _corners(low_m: Optional[Numbers], high_m: Optional[Numbers]) -> tuple[list, list]:
    """A box that is open where there is no corner."""
    far = [1e30] * 3
    low = [-x for x in far] if low_m is None else list(low_m)
    high = far if high_m is None else list(high_m)
    if len(low) != 3 or len(high) != 3:
        raise ValueError("the corner of a box has three coordinates")
    return low, high


class Solid:
    """Elements, materials, supports and loads: a problem of the 3D engine, and where it is.

        rubber = dea.Part("neo-hookean", [0.4e6])
        block = dea.Solid([rubber], box_m=(0.01, 0.01, 0.04), elements=(1, 1, 2))
        block.hold("xyz", high_m=(1, 1, 0))
        block.hold("z", (0, 0, 0.04), low_m=(0, 0, 0.04))
        block.solve()
        block["reaction_N"]

    solid[NAME] is an array with a unit or a number:
      points_m, displacement_m, reaction_N, force_N [points, 3];
      mode_Hz [modes] (negative: unstable), mode_shape [modes, points, 3] after modes();
      body_shift_m, body_turn_rad, body_force_N, body_moment_N_m [bodies, 3]: where bodies are and
      what holds them; spring_force_N, spring_moment_N_m [springs]: what springs pull back by;
      channel_V, charge_C [channels + 1], capacitance_held_F, capacitance_F [channels + 1, same]
      after find_charges(), ground first;
      voltage_V, energy_J, unstable_modes, iterations, load, arc.
    points_m lies in the library, read-only, as long as it lives; all others are copies.

    Supports, loads and voltages are goals of the next solve. A solve that fails (SolverError), and
    one that Ctrl-C ends, leave the solid at its last equilibrium. Other threads of Python run while
    it solves; a solid itself belongs to one thread at a time.
    """

    def __init__(self, parts: Sequence[Part], *, box_m: Optional[Numbers] = None,
                 elements: Optional[Sequence[int]] = None, points_m: Any = None, cells: Any = None,
                 part_of: Any = None, msh_file: Optional[Path] = None, msh_unit_m: float = 1e-3,
                 ply_thickness_m: Numbers = (), ply_elements: Optional[Sequence[int]] = None,
                 fills: Sequence[Union[Fill, tuple]] = (), bodies: Sequence[Body] = (),
                 order: int = 2, order_z: int = 2):
        """The mesh is one of three:

        box_m, elements: a box from the origin, of part 0, with so many elements along x, y, z.
        points_m, cells, part_of: points [n, 3], hexahedra [m, (order + 1)^2 (order_z + 1)] with
        nodes from 0, first local axis fastest, at Gauss-Lobatto points; part of each (None: 0).
        msh_file, ply_thickness_m, fills: a plane mesh of quadrilaterals from a file of Gmsh
        (lengths in units of msh_unit_m), extruded through plies from z = 0 up, with so many
        elements through each (ply_elements, None: 1), and the parts that plies have where; later
        fills over earlier ones.

        order, order_z: of the elements in the plane and through the thickness, 1 to 3. bodies: at
        first free; they bring two points each, behind those of the mesh.
        """
        kept: list = []
        options = _struct("dea_solid_options", kept, order=order, order_z=order_z,
                          parts=_pointers("dea_part", [_part(p, kept) for p in parts], kept),
                          part_count=len(parts), body_count=len(bodies),
                          bodies=_pointers("dea_body", [_body(b, kept) for b in bodies], kept))
        if box_m is not None:
            options.box_m, options.elements = list(box_m), list(elements or (1, 1, 1))
        if points_m is not None:
            self._set_cells(options, points_m, cells, part_of, kept)
        if msh_file is not None:
            self._set_plies(options, msh_file, ply_thickness_m, ply_elements, fills, kept)
            options.msh_unit_m = msh_unit_m
        self._context, out = Context(), ffi.new("dea_solid **")
        self._context.check(lib.dea_solid_new(self._context.handle, options, out))
        self._handle = self._context.own(out[0], lib.dea_solid_free)
        self._springs = 0

    @staticmethod
    def _set_cells(options: Any, points_m: Any, cells: Any, part_of: Any, kept: list) -> None:
        nodes = (options.order + 1)**2 * (options.order_z + 1)
        options.points_m = _doubles(points_m, (-1, 3), kept)
        options.point_count = len(points_m)
        options.cells = _doubles(cells, (-1, nodes), kept, "int")
        options.cell_count = len(cells)
        if part_of is not None:
            options.part_of = _doubles(part_of, (len(cells),), kept, "int")

    @staticmethod
    def _set_plies(options: Any, msh_file: Path, thickness_m: Numbers,
                   elements: Optional[Sequence[int]], fills: Sequence[Union[Fill, tuple]],
                   kept: list) -> None:
        options.msh_file = _text(os.fspath(msh_file), kept)
        options.ply_thickness_m = _doubles(thickness_m, (-1,), kept)
        options.ply_count = len(thickness_m)
        if elements is not None:
            if len(elements) != len(thickness_m):
                raise ValueError(f"{len(elements)} numbers of elements of {len(thickness_m)} plies")
            kept.append(ffi.new("size_t[]", list(elements)))
            options.ply_elements = kept[-1]
        filled = ffi.new("dea_fill[]", len(fills))
        for to, fill in zip(filled, fills):
            one = fill if isinstance(fill, Fill) else Fill(*fill)
            to.ply, to.group, to.part = one.ply, _text(one.group, kept), one.part
        kept.append(filled)
        options.fills, options.fill_count = filled, len(fills)

    def _call(self, function: Any, *arguments: Any) -> None:
        self._context.check(function(self._context.handle, self._handle.pointer, *arguments))

    def _hold(self, components: Components, displacement: Any, low_m: Optional[Numbers],
              high_m: Optional[Numbers], curve: Optional[str], nodes: Optional[Nodes]) -> None:
        kept: list = []
        low, high = _corners(low_m, high_m)
        mask = _mask(components, _AXES[:3])
        if nodes is not None:
            if curve is not None or low_m is not None or high_m is not None:
                raise ValueError("nodes by their numbers, or by a place")
            self._call(lib.dea_solid_hold_nodes, *_nodes(nodes, kept), mask, displacement)
        elif curve is not None:
            self._call(lib.dea_solid_hold_curve, _text(curve, kept), low, high, mask, displacement)
        else:
            self._call(lib.dea_solid_hold, low, high, mask, displacement)

    def hold(self, components: Components, displacement_m: Numbers = (0, 0, 0), *,
             low_m: Optional[Numbers] = None, high_m: Optional[Numbers] = None,
             curve: Optional[str] = None, nodes: Optional[Nodes] = None) -> None:
        """Holds components ("xz") of the nodes with low_m <= X <= high_m at a displacement that the
        next solve goes to; curve: of these only nodes on, above and below a physical curve of the
        .msh file. nodes: those with these numbers (rows of points_m, or True for each) instead."""
        self._hold(components, list(displacement_m), low_m, high_m, curve, nodes)

    def release(self, components: Components, *, low_m: Optional[Numbers] = None,
                high_m: Optional[Numbers] = None, curve: Optional[str] = None,
                nodes: Optional[Nodes] = None) -> None:
        """Frees what hold holds."""
        self._hold(components, ffi.NULL, low_m, high_m, curve, nodes)

    def hold_body(self, body: int, components: Components = _AXES,
                  shift_m: Numbers = (0, 0, 0), turn_rad: Numbers = (0, 0, 0)) -> None:
        """Holds components of a body ("x", "y", "z" of its shift, "rx", "ry", "rz" of its rotation
        vector) at values that the next solve goes to."""
        self._call(lib.dea_solid_hold_body, body, _mask(components, _AXES), list(shift_m),
                   list(turn_rad))

    def release_body(self, body: int, components: Components = _AXES) -> None:
        """Frees what hold_body holds."""
        self._call(lib.dea_solid_hold_body, body, _mask(components, _AXES), ffi.NULL, ffi.NULL)

    def push_body(self, body: int, force_N: Numbers = (0, 0, 0),
                  moment_N_m: Numbers = (0, 0, 0)) -> None:
        """A dead force at the centre of a body, and a moment (while turns are small), in place of
        what was there."""
        self._call(lib.dea_solid_push_body, body, list(force_N), list(moment_N_m))

    def add_spring(self, body: int, component: str, *, place: float = 0, stiffness: float = 0,
                   table: Optional[tuple[Numbers, Numbers]] = None) -> int:
        """A spring between a component of a body ("z", "rx") and the outside, which pulls back by
        F(y), y: how far the component is beyond place (m, or rad). F = stiffness y (N/m, or
        N m/rad), or a table (y rising, F): a monotone cubic, straight on beyond its ends. Returns
        its number. The next solve brings its outer end from where the body is to its place."""
        kept: list = []
        spring = _struct("dea_body_spring", kept, body=body, component=_mask([component], _AXES),
                         place=place, stiffness=stiffness)
        if table is not None:
            at, force = table
            spring.count = len(at)
            spring.at = _doubles(at, (-1,), kept)
            spring.force = _doubles(force, (len(at),), kept)
        self._call(lib.dea_solid_add_spring, spring)
        self._springs += 1
        return self._springs - 1

    def move_spring(self, spring: int, place: float) -> None:
        """Another place of a spring's outer end (m, or rad), that the next solve goes to."""
        self._call(lib.dea_solid_move_spring, spring, float(place))

    def pull(self, traction_Pa: Numbers, *, low_m: Optional[Numbers] = None,
             high_m: Optional[Numbers] = None) -> None:
        """Adds a force per reference area on the faces of elements whose middles are there; an
        outer face of the solid is a box without thickness."""
        low, high = _corners(low_m, high_m)
        self._call(lib.dea_solid_pull, low, high, list(traction_Pa))

    def set_channel(self, channel: int, voltage_V: float) -> None:
        """Voltage of a channel beside that of solve, which all channels have."""
        self._call(lib.dea_solid_set_channel, channel, float(voltage_V))

    def solve(self, voltage_V: float = 0) -> None:
        """Stable equilibrium with these supports, loads and voltage, in steps where they are
        needed. SolverError when there is none."""
        self._call(lib.dea_solid_solve, float(voltage_V))

    def find_charges(self) -> None:
        """Charges and capacitances at the last equilibrium, with the film held and moving."""
        self._call(lib.dea_solid_find_charges)

    def modes(self, count: int) -> None:
        """The lowest natural modes at the last equilibrium, 1 to 200."""
        self._call(lib.dea_solid_modes, count)

    def path_begin(self, voltage_V: float = 0, *, step: float, unit_m: float) -> None:
        """Begins a path by arc-length, through unstable equilibria too, from the last equilibrium
        (load 0) to what is now asked for (load 1), and beyond. step: length of the first step
        (below 0: the other way); unit_m: a displacement that counts as much as the whole load."""
        self._call(lib.dea_solid_path_begin, float(voltage_V), float(step), float(unit_m))

    def path_step(self) -> None:
        """The next point of the path: load, arc, voltage_V, unstable_modes."""
        self._call(lib.dea_solid_path_step)

    def mesh(self) -> Mesh:
        """Stretches, stresses, tension, field, energy and error of volume at the last equilibrium:
        a copy. A point is one node in one ply and part; "region" of a cell is its part."""
        out = ffi.new("dea_mesh **")
        self._call(lib.dea_solid_mesh, out)
        return Mesh(out[0], self._handle)._copied()

    @property
    def settings(self) -> Mapping[str, Setting]:
        """Tolerances and limits of the solvers by name, as they are."""
        found: dict[str, Setting] = {}
        while True:
            s = lib.dea_solid_setting_at(self._context.handle, self._handle.pointer, len(found))
            if s == ffi.NULL:
                return found
            found[text(s.name)] = Setting(text(s.name), text(s.unit), text(s.meaning), s.value)

    def set(self, name: str, value: float) -> None:
        """Changes a setting for the solves to come."""
        self._call(lib.dea_solid_set, _text(name, []), float(value))

    def __getitem__(self, name: str) -> Union[float, Array]:
        number = ffi.new("double *")
        key = name.encode()
        if lib.dea_solid_number(self._context.handle, self._handle.pointer, key,
                                number) == lib.DEA_OK:
            return number[0]
        out = ffi.new("dea_array **")
        self._call(lib.dea_solid_array, key, out)
        array = _array(out[0], self._handle)
        return array if name == "points_m" else array.copy()
