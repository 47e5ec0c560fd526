"""The paper's actuator at equal error of the fibre tip: model 3d beside dolfinx (python3-dolfinx 0.5). Prints a
section of the page of beside_dolfinx.py.

    python3 verify/beside_dolfinx_tip.py DEA ROOT

examples/frdea-4.yaml, 0 to 4 kV in steps of 1 kV, a sector of 45 degrees. Both programs solve the energy of
docs/theory/solid.md with triquadratic hexahedra and pressures that are linear in each. dolfinx gets it on two
kinds of meshes: those of `dea mesh`, and those of quadrilaterals that gmsh makes of the outlines, fine along the
fibre and the electrode's edge and growing from there. Mirror planes that no axis is normal to are held by a stiff spring, which
costs dolfinx nothing.
"""
import csv
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time

from beside_dolfinx import EPSILON, FACTS, MM, POISSON, YEOH, YOUNG, measured, read_msh, run_measured

VOLTAGES = (1e3, 2e3, 3e3, 4e3)
STRETCH, THICKNESS, FIBRE = 1.5, 0.1 / 1.5**2, 0.1  # thickness of the stretched film, of the fibre [mm]
ELECTRODE, FRAME, HALF = 3.75, 15.0, 1.0  # radii, half of the fibre's width [mm]
SPRING = 1e8  # MPa/mm of the oblique mirror plane
OBLIQUE = math.pi / 4
# Sizes of gmsh's elements over those at refinement 1 [mm]: FINE at the edges, growing by GROWTH of the distance up to
# COARSE. Of six gradings this one had the least error for its time.
FINE, GROWTH, COARSE = 0.1, 0.3, 1.5
SIZES = (2, 1.4, 1, 0.7, 0.5)
REFINEMENTS = (1, 1.25, 1.5, 1.75, 2)
SAME = 1e-5  # of the tips on the same mesh
WANTED = 25


def energy_of(domain, kinds, faces, w, field):
    """The energy at displacements and pressures w; kinds: 1 film, 2 driven film, 3 fibre; faces: 1 oblique."""
    import ufl

    dx = ufl.Measure("dx", domain=domain, subdomain_data=kinds, metadata={"quadrature_degree": 5})
    ds = ufl.Measure("ds", domain=domain, subdomain_data=faces, metadata={"quadrature_degree": 5})
    u, p = ufl.split(w)
    F = ufl.Identity(3) + ufl.grad(u)
    J, l = ufl.det(F), STRETCH
    slope = sum((k + 1) * c * (2 * l**2 + l**-4 - 3) ** k for k, c in enumerate(YEOH))
    p_flat = -2 * slope * l**-4
    FG = F * ufl.as_matrix([[l, 0, 0], [0, l, 0], [0, 0, l**-2]])
    i = ufl.inner(FG, FG) - 3
    film = sum(c * i ** (k + 1) for k, c in enumerate(YEOH)) + (p_flat + p) * (J - 1)
    film += abs(p_flat) / 4 * ((J**2 - 1) / 2 - ufl.ln(J))
    area = ufl.cross(F[:, 0], F[:, 1])
    mu, lam = YOUNG / 2 / (1 + POISSON), YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
    fibre = mu / 2 * (ufl.inner(F, F) - 3 - 2 * ufl.ln(J)) + lam / 2 * ufl.ln(J) ** 2 - p**2 / 2
    normal = ufl.as_vector([-math.sin(OBLIQUE), math.cos(OBLIQUE), 0])
    return (film * dx(1) + (film - field / 2 * ufl.inner(area, area)) * dx(2) + fibre * dx(3)
            + SPRING / 2 * ufl.inner(u, normal) ** 2 * ds(1))


def make_mesh(path):
    import numpy as np
    import ufl
    from dolfinx import cpp, mesh
    from mpi4py import MPI

    x, cells, names = read_msh(path)
    kind = np.array([{"film": 1, "film_active": 2}.get(name, 3) for name in names])
    order = cpp.io.perm_gmsh(mesh.CellType.hexahedron, 27)
    body = ufl.Mesh(ufl.VectorElement("Lagrange", "hexahedron", 2))
    domain = mesh.create_mesh(MPI.COMM_SELF, cells[:, order], x, body)
    kind = kind[np.array(domain.topology.original_cell_index)].astype(np.int32)
    kinds = mesh.meshtags(domain, 3, np.arange(len(kind), dtype=np.int32), kind)
    domain.topology.create_connectivity(2, 3)
    oblique = mesh.locate_entities_boundary(
        domain, 2, lambda X: np.abs(X[1] * math.cos(OBLIQUE) - X[0] * math.sin(OBLIQUE)) < 1e-7)
    return domain, kinds, mesh.meshtags(domain, 2, np.sort(oblique), np.ones(len(oblique), np.int32))


def tip_height(domain, u):
    """z of the interface of film and fibre at the tip on its axis [um]."""
    import numpy as np
    from dolfinx import geometry

    X = np.array([[ELECTRODE + 1e-7, 1e-9, THICKNESS / 2 * (1 - 1e-9)]])
    tree = geometry.BoundingBoxTree(domain, 3)
    near = geometry.compute_colliding_cells(domain, geometry.compute_collisions(tree, X), X)
    return 1e3 * float(np.ravel(u.eval(X, near.links(0)[:1]))[2])


def run_dolfinx(path, solve):
    """Child process: solves the mesh of a file and prints its facts; or compiles the forms only."""
    import numpy as np
    import ufl
    from dolfinx import fem
    from petsc4py import PETSc

    domain, kinds, faces = make_mesh(path)
    space = fem.FunctionSpace(domain, ufl.MixedElement(ufl.VectorElement("Lagrange", "hexahedron", 2),
                                                       ufl.FiniteElement("DPC", "hexahedron", 1)))
    w = fem.Function(space)
    field = fem.Constant(domain, PETSc.ScalarType(0))
    residual = ufl.derivative(energy_of(domain, kinds, faces, w, field), w)
    force, tangent = fem.form(residual), fem.form(ufl.derivative(residual, w))
    if not solve:
        return
    shifts, numbers = space.sub(0).collapse()
    across, _ = space.sub(0).sub(1).collapse()
    rim = fem.locate_dofs_geometrical((space.sub(0), shifts),
                                      lambda X: np.hypot(X[0], X[1]) > FRAME - 1e-6)
    axis = fem.locate_dofs_geometrical((space.sub(0).sub(1), across), lambda X: np.abs(X[1]) < 1e-9)
    held = [fem.dirichletbc(fem.Function(shifts), rim, space.sub(0)),
            fem.dirichletbc(fem.Function(across), axis, space.sub(0).sub(1))]
    A, b = fem.petsc.create_matrix(tangent), fem.petsc.create_vector(force)
    A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    solver = PETSc.KSP().create(domain.comm)
    solver.setOperators(A)
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    solver.getPC().setFactorSolverType("mumps")
    step, factors, at, heights = A.createVecRight(), 0, time.process_time(), []
    for V in VOLTAGES:
        field.value = EPSILON * (V / (THICKNESS / MM)) ** 2 * 1e-6
        moved = np.inf
        while not moved < 1e-6:  # mm, and Newton's method squares it
            A.zeroEntries()
            fem.petsc.assemble_matrix(A, tangent, bcs=held)
            A.assemble()
            b.set(0)
            fem.petsc.assemble_vector(b, force)
            fem.petsc.set_bc(b, held)
            solver.setUp()
            solver.solve(b, step)
            factors += 1
            w.x.array[:] -= step.array
            moved = np.abs(step.array[numbers]).max()
            if not moved < 100 or factors > 200:
                sys.exit(f"dolfinx: no equilibrium at {V} V")
        heights.append(tip_height(domain, w.sub(0).collapse()))
    print(FACTS, json.dumps({"loop_s": time.process_time() - at, "factors": factors, "unknowns": len(numbers),
                             "z_um": heights}))


def outlines(size):
    """A script for gmsh: quadrilaterals of order 2 in a sector of the disc."""
    a, b, slant = ELECTRODE, FRAME, math.cos(OBLIQUE)
    points = [(0, 0), (a, 0), (math.sqrt(a * a - HALF**2), HALF), (a * slant, a * slant), (b, 0),
              (math.sqrt(b * b - HALF**2), HALF), (b * slant, b * slant)]
    places = "".join(f"Point({i + 1})={{{x!r},{y!r},0}};\n" for i, (x, y) in enumerate(points))
    return places + f"""
Line(1)={{1,2}}; Circle(2)={{2,1,3}}; Circle(3)={{3,1,4}}; Line(4)={{4,1}}; Line(5)={{2,5}};
Circle(6)={{5,1,6}}; Line(7)={{6,3}}; Circle(8)={{6,1,7}}; Line(9)={{7,4}};
Curve Loop(1)={{1,2,3,4}}; Plane Surface(1)={{1}};
Curve Loop(2)={{5,6,7,-2}}; Plane Surface(2)={{2}};
Curve Loop(3)={{-7,8,9,-3}}; Plane Surface(3)={{3}};
Physical Surface("film_active")={{1}}; Physical Surface("fibre")={{2}}; Physical Surface("film")={{3}};
Field[1]=Distance; Field[1].CurvesList={{2,3,7}}; Field[1].NumPointsPerCurve=400;
Field[2]=MathEval; Field[2].F="{2 * size}*min({COARSE},{FINE}+{GROWTH}*F1)";
Background Field=2; Mesh.MeshSizeExtendFromBoundary=0; Mesh.MeshSizeFromPoints=0;
Mesh.Algorithm=6; Mesh.RecombineAll=1; Mesh.RecombinationAlgorithm=1; Mesh.SubdivisionAlgorithm=1;
Mesh.ElementOrder=2; Mesh.SecondOrderIncomplete=0; Mesh.MshFileVersion=2.2;
"""


def read_plane(path):
    """Nodes, quadrilaterals of 9 nodes that turn left, and their surfaces' names, of Gmsh's format 2.2."""
    import numpy as np

    names = {}
    with open(path, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("$PhysicalNames"):
                for _ in range(int(next(lines))):
                    _, tag, name = next(lines).split(maxsplit=2)
                    names[tag] = name.strip().strip('"')
            elif line.startswith("$Nodes"):
                x = np.array([next(lines).split()[1:3] for _ in range(int(next(lines)))], float)
            elif line.startswith("$Elements"):
                rows = [next(lines).split() for _ in range(int(next(lines)))]
    if any(row[1] in ("2", "9") for row in rows):
        sys.exit("gmsh left triangles")
    rows = [row for row in rows if row[1] == "10"]
    quads = np.array([row[5:] for row in rows], int) - 1
    right = np.cross(x[quads[:, 1]] - x[quads[:, 0]], x[quads[:, 3]] - x[quads[:, 0]]) < 0
    quads[right] = quads[right][:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]
    return x, quads, [names[row[3]] for row in rows]


def write_solid(plane, path):
    """One element through the film, and one through the fibre on it, as a file like that of `dea mesh`."""
    x, quads, names = plane
    heights = [-THICKNESS / 2, 0, THICKNESS / 2, THICKNESS / 2 + FIBRE / 2, THICKNESS / 2 + FIBRE]
    numbers, cells, groups = {}, [], ["film", "film_active", "fibre"]
    for quad, name in zip(quads, names):
        for level, group in ((0, name if name != "fibre" else "film"), (2, "fibre"))[: 1 + (name == "fibre")]:
            low, mid, top = [[numbers.setdefault((n, level + k), len(numbers)) for n in quad] for k in range(3)]
            cells.append((groups.index(group) + 1, low[:4] + top[:4] + [
                low[4], low[7], mid[0], low[5], mid[1], low[6], mid[2], mid[3], top[4], top[7], top[5], top[6],
                low[8], mid[4], mid[7], mid[5], mid[6], top[8], mid[8]]))
    with open(path, "w", encoding="ascii") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n")
        out.writelines(f'3 {k + 1} "{group}"\n' for k, group in enumerate(groups))
        out.write(f"$EndPhysicalNames\n$Nodes\n{len(numbers)}\n")
        out.writelines(f"{k + 1} {x[n][0] / MM!r} {x[n][1] / MM!r} {heights[level] / MM!r}\n"
                       for (n, level), k in numbers.items())
        out.write(f"$EndNodes\n$Elements\n{len(cells)}\n")
        out.writelines(f"{k + 1} 12 2 {tag} {tag} {' '.join(str(n + 1) for n in nodes)}\n"
                       for k, (tag, nodes) in enumerate(cells))
        out.write("$EndElements\n")


def gmsh_mesh(size, folder):
    """Writes the mesh of that size; its file."""
    script, plane, solid = (os.path.join(folder, f"{size}.{end}") for end in ("geo", "plane", "msh"))
    with open(script, "w", encoding="ascii") as out:
        out.write(outlines(size))
    subprocess.run(["gmsh", "-2", script, "-o", plane, "-format", "msh22", "-v", "1"], check=True)
    write_solid(read_plane(plane), solid)
    return solid


def of_dolfinx(path):
    """Unknowns, processor time of the process and of its loop, and the tip at each voltage."""
    facts = measured([sys.executable, __file__, "--dolfinx", path])[0]
    return facts["unknowns"], facts["cpu_s"], facts["loop_s"], facts["z_um"]


def keys(refinement, order=2, elements=1):
    at = {"refinement": refinement, "order": order, "order_z": order, "elements_z": elements}
    return [word for key, value in at.items() for word in ("--set", f"compute.solid.{key}={value}")]


def of_dea(dea, design, folder, options, times=3):
    """Processor time, the median of some runs, and the tip at each voltage."""
    out = os.path.join(folder, "run")
    step = f"compute.voltage={{from: 0 kV, to: {VOLTAGES[-1]} V, step: {VOLTAGES[0]} V}}"
    words = [dea, "run", design, "--model", "3d", "--study", "sweep", "--no-figures", "--quiet", "--force", "-o", out]
    seconds = [measured(words + ["--set", step] + options)[0]["cpu_s"] for _ in range(times)]
    with open(os.path.join(out, "3d_sweep.csv"), encoding="utf-8") as table:
        z = [float(row["z fibre tip (um)"]) for row in csv.DictReader(table)]
    return statistics.median(seconds), z[1:]


def time_for(error, points):
    """Processor time for an error, between two points (error, time) in logarithms; None outside of them."""
    points = sorted(points)
    for (low, slow), (high, quick) in zip(points, points[1:]):
        if low <= error <= high:
            share = math.log(error / low) / math.log(high / low)
            return slow * (quick / slow) ** share
    return None


def print_section(limit, ours, same, theirs, far):
    """same: dolfinx on the meshes of ours; far: largest difference of the tips there, over them."""
    def off(z):
        return abs(z[-1] - limit)

    points, loops = [(off(z), cpu) for _, cpu, _, z in theirs], [(off(z), loop) for _, _, loop, z in theirs]
    print(f"""
## The paper's actuator at equal error of its tip

`verify/beside_dolfinx_tip.py`: [frdea-4.yaml](../../examples/frdea-4.yaml), 0 to {VOLTAGES[-1] / 1e3:g} kV in steps of 1 kV, a sector of 45
degrees, z of the fibre's tip at {VOLTAGES[-1] / 1e3:g} kV. Both programs have the same energy, elements of order 2 with linear pressures,
one through the film. Error: against {limit:.3f} um, extrapolated from elements of order 3 as in [trust.md](trust.md), all meshes are off to the same side, so that equal errors are equal tips, whatever the limit is. Processor time (`user` and `sys`) of whole processes of one thread, of dea the median of
three; the compiler of dolfinx's forms and the making of its meshes (gmsh's, read from a file) are not in it, those of
dea's are, and its files; loop: dolfinx without starting Python and setting up.

dolfinx on the meshes that gmsh makes of the outlines, {FINE:g} mm at the edges of fibre and electrode at size 1, from there
growing by {GROWTH:g} of the distance (the best of six gradings that were tried):

| size | unknowns | z of the tip (um) | error (%) | processor time (s) | loop (s) |
|---|---|---|---|---|---|""")
    for size, (unknowns, cpu, loop, z) in zip(SIZES, theirs):
        print(f"| {size:g} | {unknowns} | {z[-1]:.4f} | {100 * off(z) / abs(limit):.2f} | {cpu:.1f} | {loop:.1f} |")
    print("""
dea, and dolfinx on the same meshes (those of `dea mesh`) and on gmsh's at the same error, between its lines in logarithms:

| refinement | unknowns | z of the tip (um) | error (%) | dea (s) | dolfinx, same mesh (s) | over dea | dolfinx, same error (s) | over dea | its loop over dea |
|---|---|---|---|---|---|---|---|---|---|""")
    first = None
    for refinement, (cpu, z), (unknowns, on_same, _, _) in zip(REFINEMENTS, ours, same):
        at, loop = time_for(off(z), points), time_for(off(z), loops)
        ratio = [f"{at:.1f}", f"{at / cpu:.1f}", f"{loop / cpu:.1f}"] if at else ["-"] * 3
        first = at / cpu if first is None and at else first
        print(f"| {refinement:g} | {unknowns} | {z[-1]:.4f} | {100 * off(z) / abs(limit):.2f} | {cpu:.2f} | {on_same:.2f} | "
              f"{on_same / cpu:.1f} | " + " | ".join(ratio) + " |")
    print(f"""
* On the same meshes the tips differ by {far:.1e} of themselves at most (tolerance {SAME:g}).
* At the error of the default mesh dolfinx takes {first:.0f} times as long ({WANTED} were wanted). Most of it is the mesh, with
  blocks along the fibre. On that mesh dolfinx is {same[0][1] / ours[0][0]:.1f} times as long, and its loop alone {same[0][2] / ours[0][0]:.1f} times.""")


def main():
    dea, root = sys.argv[1:3]
    design = os.path.join(root, "examples", "frdea-4.yaml")
    quiet = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "check": True}
    with tempfile.TemporaryDirectory() as work:
        ours, same, far = [], [], 0
        for refinement in REFINEMENTS:
            mesh = os.path.join(work, f"dea{refinement}.msh")
            subprocess.run([dea, "mesh", design, "-o", mesh, *keys(refinement)], **quiet)
            if not same:
                measured([sys.executable, __file__, "--forms", mesh])  # kept on the disk
                of_dolfinx(mesh)
            ours.append(of_dea(dea, design, work, keys(refinement)))
            same.append(of_dolfinx(mesh))
            far = max([far] + [abs(a / b - 1) for a, b in zip(same[-1][3], ours[-1][1]) if abs(b) > 1])
        theirs = [of_dolfinx(gmsh_mesh(size, work)) for size in SIZES]
        finer = [of_dea(dea, design, work, keys(1 + math.log2(n), 3, n), 1)[1][-1] for n in (1, 2)]
    print_section(2 * finer[1] - finer[0], ours, same, theirs, far)
    sys.exit(0 if far < SAME else "tips are out of tolerance")


if __name__ == "__main__":
    if sys.argv[1] == "--measured":
        run_measured(sys.argv[2:])
    elif sys.argv[1] in ("--dolfinx", "--forms"):
        run_dolfinx(sys.argv[2], sys.argv[1] == "--dolfinx")
    else:
        main()
