"""The branch towards the fibres of the actuator without pre-stretch and with free ends, by another program than
model 3d: displacements triquadratic, pressure linear and discontinuous in each element of the film (no penalty
on the volume), stresses by hand, tangents by complex steps, Newton's method with SuperLU of scipy. It needs no
state of model 3d: a small dead load lifts the flat film at 0 V, the voltage is raised, the load taken away.
Fibres are compressible neo-Hookean; the field is V/h between the electrodes (docs/theory/solid.md).

    dea mesh examples/frdea-4.yaml --set 'compute.models=[3d]' --set pre_stretch=1 \\
      --set electrodes.diameter='7.5 mm stretched' --set fibres.outer_end=free -o free.msh
    python3 verify/free_branch.py free.msh [kV...]
"""
import sys

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

ELECTRODE, FRAME, THICKNESS = 3.75, 15.0, 0.1  # mm; stresses in MPa
YEOH, EPSILON = (0.1784, -0.006, 0.0042), 2.8 * 8.8541878128e-12
YOUNG, POISSON = 2950.0, 0.38
MU, LAMBDA = YOUNG / 2 / (1 + POISSON), YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
BULK = 1e6  # MPa, of the pressure: as good as none
LARGEST = 0.05  # mm that a step moves a node at most
LOAD = 1e-6  # MPa, over the film, that lifts it
NODES = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1),
                  (-1, 1, 1), (0, -1, -1), (-1, 0, -1), (-1, -1, 0), (1, 0, -1), (1, -1, 0), (0, 1, -1),
                  (1, 1, 0), (-1, 1, 0), (0, -1, 1), (-1, 0, 1), (1, 0, 1), (0, 1, 1), (0, 0, -1), (0, -1, 0),
                  (-1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)])  # of Gmsh's element 12


def shapes(x):
    """Values and slopes of the 27 functions at a point."""
    by_place = {-1: lambda t: (t * (t - 1) / 2, t - 0.5), 0: lambda t: (1 - t * t, -2 * t),
                1: lambda t: (t * (t + 1) / 2, t + 0.5)}
    v = np.array([[by_place[k](t) for k, t in zip(node, x)] for node in NODES])
    value, slope = v[..., 0], v[..., 1]
    grad = [slope[:, 0] * value[:, 1] * value[:, 2], value[:, 0] * slope[:, 1] * value[:, 2],
            value[:, 0] * value[:, 1] * slope[:, 2]]
    return value.prod(axis=1), np.array(grad).T


def read_msh(path):
    """Nodes [mm], elements of 27 nodes, and which of them are film."""
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
    film = np.array([names[row[3]].startswith("film") for row in rows])
    return 1e3 * x, np.array([row[5:] for row in rows], int) - 1, film


class Problem:
    """Unknowns: three displacements of each node, then four of the pressure of each element."""

    def __init__(self, path):
        self.X, self.cells, self.film = read_msh(path)
        count, cells = len(self.cells), self.cells
        gauss = [(-np.sqrt(0.6), 5 / 9), (0, 8 / 9), (np.sqrt(0.6), 5 / 9)]
        points = [((x, y, z), a * b * c) for x, a in gauss for y, b in gauss for z, c in gauss]
        self.grad, self.dV = np.empty((count, 27, 27, 3)), np.empty((count, 27))
        for q, (x, weight) in enumerate(points):
            slope = shapes(x)[1]
            jacobian = np.einsum("eni,nj->eij", self.X[cells], slope)
            self.grad[:, q] = np.einsum("nj,eji->eni", slope, np.linalg.inv(jacobian))
            self.dV[:, q] = weight * np.linalg.det(jacobian)
        self.N = np.array([shapes(x)[0] for x, _ in points])
        self.P = np.array([(1, *x) for x, _ in points])
        middle = self.X[cells].mean(axis=1)
        self.driven = self.film & (np.hypot(middle[:, 0], middle[:, 1]) < ELECTRODE)
        first = 3 * len(self.X)
        self.dofs = first + 4 * count
        self.at = np.hstack([(3 * cells[..., None] + np.arange(3)).reshape(count, 81),
                             first + 4 * np.arange(count)[:, None] + np.arange(4)])
        self.hold()
        self.u = np.zeros(self.dofs)
        self.u[first + 4 * np.flatnonzero(self.film)] = -2 * YEOH[0]  # free of stress
        self.load = np.zeros(self.dofs)
        share = np.einsum("eq,qn->en", self.dV / THICKNESS, self.N)[self.film]
        np.add.at(self.load, 3 * cells[self.film] + 2, share)
        self.centre = np.flatnonzero(np.hypot(self.X[:, 0], self.X[:, 1]) < 1e-9)
        tip = np.array([ELECTRODE, 0, THICKNESS / 2])
        self.tip = np.abs(self.X - tip).sum(axis=1).argmin()

    def hold(self):
        """Frame, mirror planes at 0 and 45 degrees: at the latter axes are turned."""
        X, radius = self.X, np.hypot(self.X[:, 0], self.X[:, 1])
        of_film = np.zeros(len(X), bool)
        of_film[self.cells[self.film]] = True
        held = np.zeros((len(X), 3), bool)
        held[of_film & (radius > FRAME * (1 - 1e-9))] = True
        held[np.abs(X[:, 1]) < 1e-9, 1] = True
        held[radius < 1e-9, :2] = True
        last = (np.abs(X[:, 0] - X[:, 1]) < 1e-7) & (radius > 1e-9)
        held[last, 0] = True
        turn, c = sp.lil_matrix(sp.identity(self.dofs)), np.sqrt(0.5)
        for n in np.flatnonzero(last):
            turn[3 * n, 3 * n], turn[3 * n, 3 * n + 1] = -c, c
            turn[3 * n + 1, 3 * n], turn[3 * n + 1, 3 * n + 1] = c, c
        self.turn = turn.tocsr()
        self.free = np.flatnonzero(np.hstack([~held.ravel(), np.ones(self.dofs - 3 * len(X), bool)]))

    def stress(self, q, field):
        """q: F row by row, then the pressure, last axis 10. Derivatives of the energy by them; field: eps E^2."""
        F, p = q[..., :9].reshape(q.shape[:-1] + (3, 3)), q[..., 9]
        a, b, c = F[..., 0], F[..., 1], F[..., 2]
        cof = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
        J, i = (a * cof[..., 0]).sum(axis=-1), (F * F).sum(axis=(-1, -2)) - 3
        slope = YEOH[0] + 2 * YEOH[1] * i + 3 * YEOH[2] * i * i
        film = 2 * slope[..., None, None] * F + p[..., None, None] * cof
        aa, bb, ab = ((x * y).sum(axis=-1)[..., None] for x, y in ((a, a), (b, b), (a, b)))
        film[..., 0] -= field[:, None, None] * (a * bb - b * ab)
        film[..., 1] -= field[:, None, None] * (b * aa - a * ab)
        fibre = MU * F + ((LAMBDA * np.log(J) - MU) / J)[..., None, None] * cof
        out = np.empty_like(q)
        out[..., :9] = np.where(self.film[:, None, None, None], film, fibre).reshape(F.shape[:-2] + (9,))
        out[..., 9] = np.where(self.film[:, None], J - 1 - p / BULK, p)
        return out

    def points(self):
        e = self.u[self.at]
        q = np.empty((len(e), 27, 10))
        F = np.eye(3) + np.einsum("eqnj,eni->eqij", self.grad, e[:, :81].reshape(-1, 27, 3))
        q[..., :9] = F.reshape(-1, 27, 9)
        q[..., 9] = e[:, 81:] @ self.P.T
        return q

    def system(self, V, load):
        """Residual and tangent."""
        field = self.driven * EPSILON * (V / (1e-3 * THICKNESS))**2 * 1e-6
        q, n = self.points(), len(self.cells)
        S, D = self.stress(q, field), np.empty(q.shape + (10,))
        for k in range(10):
            turned = q.astype(complex)
            turned[..., k] += 1e-30j
            D[..., k] = self.stress(turned, field).imag / 1e-30
        B = np.zeros((n, 27, 10, 85))
        for k in range(9):
            B[:, :, k, k // 3:81:3] = self.grad[..., k % 3]
        B[:, :, 9, 81:] = self.P
        r = -load * self.load
        np.add.at(r, self.at, np.einsum("eqiG,eqi,eq->eG", B, S, self.dV, optimize=True))
        K = np.einsum("eqiG,eqiH->eGH", B, (D * self.dV[..., None, None]) @ B, optimize=True)
        rows, columns = np.repeat(self.at, 85, axis=1).ravel(), np.tile(self.at, (1, 85)).ravel()
        return r, sp.csc_matrix((K.ravel(), (rows, columns)), shape=(self.dofs, self.dofs))

    def solve(self, V, load):
        """Newton's method; returns how many steps it took."""
        f = self.free
        for steps in range(30):
            r, K = self.system(V, load)
            K = (self.turn @ K @ self.turn.T).tocsc()[f][:, f]
            step = np.zeros(self.dofs)
            step[f] = splu(K).solve(-(self.turn @ r)[f])
            step = self.turn.T @ step
            moved = np.abs(step[:3 * len(self.X)]).max()
            self.u += min(1, LARGEST / moved) * step
            if moved < 1e-9:
                return steps + 1
        raise ArithmeticError(f"no equilibrium at {V} V")


def main():
    problem = Problem(sys.argv[1])
    voltages = [1e3 * float(v) for v in sys.argv[2:]] or [700.0]
    first = voltages[0]
    path = [(0, 0.2), (0, 1), (0.5 * first, 1), (first, 1), (first, 0.5), (first, 0.25), (first, 0.1), (first, 0)]
    for V, load in path + [(v, 0) for v in voltages[1:]]:
        steps = problem.solve(V, load * LOAD)
        z = 1e3 * problem.u[2::3]
        print(f"{V:g} V, {1e6 * load * LOAD:g} Pa: centre {z[problem.centre].mean():.4f} um, "
              f"tip {z[problem.tip]:.4f} um, {steps} steps", flush=True)


if __name__ == "__main__":
    main()
