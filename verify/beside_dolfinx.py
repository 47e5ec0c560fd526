"""A free mesh of 300 k unknowns: model 3d beside dolfinx (python3-dolfinx 0.5), one process each, and on two
ranks. Prints a page.

    python3 verify/beside_dolfinx.py DEA ROOT [refinement]

The device is examples/devices/array-3x3.yaml, all of it, with a solid film. dolfinx gets the nodes and elements
that `dea mesh` wrote and the energy of docs/theory/solid.md: displacements in triquadratic hexahedra, the
pressure linear in each, 27 Gauss points; forces and tangents by its form compiler, Newton's method, the Cholesky
(LDL^T) factor of MUMPS. The two programs share the mesh, the law and the factorisation, and no line of code.
"""
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

VOLTAGE = 2000.0
PLACES = {"middle": (0, 0), "neighbour": (12, 0)}  # monitors of the design [mm]
MM, STRETCH, THICKNESS, PRESSURE = 1e3, 1.3, 0.1, 200e-6  # lengths in mm, stresses in MPa
CELL, PITCH, HALF = 3.5, 12.0, 19.0  # radius of a cell, their distance, half of the film's width
YEOH, EPSILON = (0.1784, -0.006, 0.0042), 2.8 * 8.8541878128e-12
YOUNG, POISSON = 2950.0, 0.38
TOLERANCE = 1e-5  # of the heights
FACTS = "facts of the run:"  # begins the line that a child prints for its parent


def read_msh(path):
    """Nodes [mm], elements of 27 nodes and the name of each one's group, of Gmsh's format 2.2."""
    import numpy as np

    names = {}
    with open(path, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("$PhysicalNames"):
                for _ in range(int(next(lines))):
                    _, number, name = next(lines).split(maxsplit=2)
                    names[number] = name.strip().strip('"')
            elif line.startswith("$Nodes"):
                x = np.array([next(lines).split()[1:] for _ in range(int(next(lines)))], float)
            elif line.startswith("$Elements"):
                rows = [next(lines).split() for _ in range(int(next(lines)))]
    rows = [row for row in rows if row[1] == "12"]
    return MM * x, np.array([row[5:] for row in rows], int) - 1, [names[row[3]] for row in rows]


def make_mesh(path):
    """The mesh, its elements' kinds (1 film, 2 below a cell, 3 driven, 4 the grid) and the pressed faces."""
    import numpy as np
    import ufl
    from dolfinx import cpp, mesh
    from mpi4py import MPI

    x, cells, names = read_msh(path)
    film = np.array([name.startswith("film") for name in names])
    middle = x[cells].mean(axis=1)[:, :2]
    below = film & (np.hypot(*(middle - PITCH * np.round(middle / PITCH)).T) < CELL)
    kind = np.where(~film, 4, np.where(below & (np.hypot(*middle.T) < CELL), 3, np.where(below, 2, 1)))
    order = cpp.io.perm_gmsh(mesh.CellType.hexahedron, 27)
    body = ufl.Mesh(ufl.VectorElement("Lagrange", "hexahedron", 2))
    domain = mesh.create_mesh(MPI.COMM_SELF, cells[:, order], x, body)
    kind = kind[np.array(domain.topology.original_cell_index)].astype(np.int32)
    kinds = mesh.meshtags(domain, 3, np.arange(len(kind), dtype=np.int32), kind)
    domain.topology.create_connectivity(2, 3)
    beside = domain.topology.connectivity(2, 3)
    faces = mesh.locate_entities_boundary(domain, 2, lambda X: np.abs(X[2]) < 1e-9)
    faces = np.array([f for f in faces if kind[beside.links(f)[0]] in (2, 3)], np.int32)
    return domain, kinds, mesh.meshtags(domain, 2, faces, np.ones(len(faces), np.int32))


def energy_of(domain, kinds, faces, w, field, pressure):
    """The energy of docs/theory/solid.md at displacements and pressures w."""
    import ufl

    rule = {"quadrature_degree": 5}  # 3 points an axis
    dx = ufl.Measure("dx", domain=domain, subdomain_data=kinds, metadata=rule)
    ds = ufl.Measure("ds", domain=domain, subdomain_data=faces, metadata=rule)
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
    grid = mu / 2 * (ufl.inner(F, F) - 3 - 2 * ufl.ln(J)) + lam / 2 * ufl.ln(J) ** 2 - p**2 / 2
    return (film * dx(1) + film * dx(2) + (film - field / 2 * ufl.inner(area, area)) * dx(3) + grid * dx(4)
            - pressure * u[2] * area[2] * ds(1))


def heights(domain, u):
    """z of the monitors' places [um]: the mean of the film's two faces there, as dea has it."""
    import numpy as np
    from dolfinx import geometry

    tree, out = geometry.BoundingBoxTree(domain, 3), {}
    for name, (x, y) in PLACES.items():
        faces = []
        for share in (1e-9, 1 - 1e-9):
            X = np.array([[x, y, share * THICKNESS / STRETCH**2]], float)
            near = geometry.compute_colliding_cells(domain, geometry.compute_collisions(tree, X), X)
            faces.append(1e3 * float(np.ravel(u.eval(X, near.links(0)[:1]))[2]))
        out[name] = sum(faces) / 2
    return out


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
    V_over_h = VOLTAGE / (THICKNESS / STRETCH**2 / MM)
    field = fem.Constant(domain, PETSc.ScalarType(EPSILON * V_over_h**2 * 1e-6))
    pressure = fem.Constant(domain, PETSc.ScalarType(PRESSURE))
    residual = ufl.derivative(energy_of(domain, kinds, faces, w, field, pressure), w)
    force, tangent = fem.form(residual), fem.form(ufl.derivative(residual, w))
    if not solve:
        return
    facts = {"assemble_s": 0.0, "factor_s": 0.0, "factors": 0}
    shifts, numbers = space.sub(0).collapse()
    held = fem.locate_dofs_geometrical(
        (space.sub(0), shifts), lambda X: np.max(np.abs(X[:2]), axis=0) > HALF - 1e-9)
    clamp = fem.dirichletbc(fem.Function(shifts), held, space.sub(0))
    A, b = fem.petsc.create_matrix(tangent), fem.petsc.create_vector(force)
    A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    solver = PETSc.KSP().create(domain.comm)
    solver.setOperators(A)
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    solver.getPC().setFactorSolverType("mumps")
    step, moved = A.createVecRight(), np.inf
    while not moved < 1e-8:  # mm
        at = time.process_time()
        A.zeroEntries()
        fem.petsc.assemble_matrix(A, tangent, bcs=[clamp])
        A.assemble()
        b.set(0)
        fem.petsc.assemble_vector(b, force)
        fem.petsc.set_bc(b, [clamp])
        facts["assemble_s"] += time.process_time() - at
        at = time.process_time()
        solver.setUp()
        solver.solve(b, step)
        facts["factor_s"] += time.process_time() - at
        facts["factors"] += 1
        w.x.array[:] -= step.array
        moved = np.abs(step.array[numbers]).max()
        if not moved < 100:
            sys.exit("dolfinx: no equilibrium")
    facts |= {"unknowns": len(numbers), "pressures": len(w.x.array) - len(numbers)}
    facts["z_um"] = heights(domain, w.sub(0).collapse())
    print(FACTS, json.dumps(facts))


def run_measured(words):
    """Runs a command and prints what it took; under mpirun one line a rank."""
    at = time.monotonic()
    child = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    if child.returncode != 0:
        sys.exit(child.stdout + child.stderr)
    inner = [line[len(FACTS):] for line in child.stdout.splitlines() if line.startswith(FACTS)]
    print(FACTS, json.dumps({"wall_s": time.monotonic() - at, "cpu_s": used.ru_utime + used.ru_stime,
                             "memory_GB": 1024e-9 * used.ru_maxrss} | (json.loads(inner[0]) if inner else {})),
          flush=True)


def measured(words, ranks=1):
    """Facts of each rank of a command. One thread of BLAS a process."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
                                "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                                "OMPI_MCA_mpi_yield_when_idle": "1"}
    start = ["mpirun", "-n", str(ranks), "--oversubscribe"] if ranks > 1 else []
    say = subprocess.run(start + [sys.executable, __file__, "--measured"] + words, env=environment, text=True,
                         stdout=subprocess.PIPE, check=True).stdout
    return [json.loads(part.split("\n")[0]) for part in say.split(FACTS)[1:]]


def run_dea(dea, design, options, folder, ranks=1):
    """Facts of model 3d at the voltage."""
    facts = measured([dea, "run", design, "--model", "3d", "--no-figures", "--quiet", "-o", folder, *options], ranks)
    with open(os.path.join(folder, "3d_sweep.csv"), encoding="utf-8") as table:
        z = {place: float(row[f"{place} z (um)"]) for row in csv.DictReader(table) for place in PLACES}
    return {"wall_s": max(f["wall_s"] for f in facts), "cpu_s": sum(f["cpu_s"] for f in facts),
            "memory_GB": sum(f["memory_GB"] for f in facts), "z_um": z}


def row(name, facts, base):
    """A line of the table: what it took, and over the first line's."""
    cells = [f"{facts[key]:.{digits}f} ({facts[key] / base[key]:.2f})"
             for key, digits in (("cpu_s", 0), ("wall_s", 0), ("memory_GB", 2))]
    return f"| {name} | " + " | ".join(cells + [f"{facts['z_um'][place]:.4f}" for place in PLACES]) + " |"


def main():
    dea, root = sys.argv[1:3]
    refinement = sys.argv[3] if len(sys.argv) > 3 else "1.6"
    design = os.path.join(root, "examples", "devices", "array-3x3.yaml")
    options = ["--set", "compute.solid.domain=whole", "--set", "compute.solid.film=solid",
               "--set", f"compute.solid.refinement={refinement}"]
    at_voltage = ["--set", f"compute.voltage={{from: {VOLTAGE} V, to: {VOLTAGE} V, step: 1 kV}}"]
    quiet = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "check": True}
    with tempfile.TemporaryDirectory() as work:
        mesh, sector = os.path.join(work, "mesh.msh"), os.path.join(work, "sector.msh")
        subprocess.run([dea, "mesh", design, "-o", sector, *options[2:4]], **quiet)
        forms = measured([sys.executable, __file__, "--forms", sector])[0]["wall_s"]  # kept on the disk
        said = subprocess.run([dea, "mesh", design, "-o", mesh, "--json", *options], **quiet).stdout
        load = [os.getloadavg()[0]]
        ours = run_dea(dea, design, options + at_voltage, os.path.join(work, "one"))
        theirs = measured([sys.executable, __file__, "--dolfinx", mesh])[0]
        load.append(os.getloadavg()[0])
        two = run_dea(dea, design, options + at_voltage, os.path.join(work, "two"), 2)
        load.append(os.getloadavg()[0])
    size = json.loads(said)
    far = max(abs(theirs["z_um"][place] / ours["z_um"][place] - 1) for place in PLACES)
    apart = max(abs(two["z_um"][place] / ours["z_um"][place] - 1) for place in PLACES)
    print(f"""# A large free mesh beside dolfinx, and on two ranks

Made by `scripts/verify beside_dolfinx`; not to be edited. `examples/devices/array-3x3.yaml`, all of it with a solid film,
refinement {refinement}: nine cells under 200 Pa, the middle one at {VOLTAGE / 1e3:g} kV. gmsh's mesh of {size["elements"]} quadratic hexahedra with
{size["unknowns"]} unknowns, as `dea mesh` writes it, is solved by `dea run` and, with the same energy, by a program for dolfinx 0.5.2
(`verify/beside_dolfinx.py`: {theirs["unknowns"]} displacements and {theirs["pressures"]} pressures, Newton's method from the flat film, LDL^T of
MUMPS), one process each with one thread. Whole processes: `dea run` also makes the mesh, estimates errors, and writes its files; dolfinx reads the mesh and has its forms compiled ({forms:.0f} s by the clock, not in the
table). Over the first line in brackets.

| | processor time (s) | clock (s) | memory (GB) | z of the middle cell (um) | of its neighbour (um) |
|---|---|---|---|---|---|
{row("dea", ours, ours)}
{row("dolfinx", theirs, ours)}
{row("dea, two ranks", two, ours)}

* The two programs' heights differ by {far:.1e} of themselves (tolerance {TOLERANCE:g}), those on one rank and on two by {apart:.1e}.
  Both are means of the film's two faces.
* dolfinx: {theirs["factors"]} factorisations and solutions in {theirs["factor_s"]:.0f} s, as many assemblies in {theirs["assemble_s"]:.0f} s.
* Two ranks: processor time and memory are sums of both.

* Load of the machine, which has {os.cpu_count()} processors: {load[0]:.1f} before, {load[1]:.1f} and {load[2]:.1f} after; with more than that the clock measures the
  other work, and processor time is what compares.""")
    sys.exit(0 if far < TOLERANCE and apart < 1e-6 else "heights are out of tolerance")


if __name__ == "__main__":
    if sys.argv[1] == "--measured":
        run_measured(sys.argv[2:])
    elif sys.argv[1] in ("--dolfinx", "--forms"):
        run_dolfinx(sys.argv[2], sys.argv[1] == "--dolfinx")
    else:
        main()
