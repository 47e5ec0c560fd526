"""The edge of an electrode in two dimensions: a program that knows nothing of this project.

Plane strain, the cut along a fibre. A film |z| < h/2, 0 < x < b, between electrodes for x < a; a plate of
PET on it from x = a to b. x = 0 is a plane of symmetry, x = b is held. The film is an incompressible Yeoh
solid, pre-stretched by l in the plane. Unknowns: displacements and the potential in biquadratic elements,
the pressure linear and discontinuous. Energy of the film, per volume of the stretched flat film:

    W(I1) + p (J - 1 - p/(2K)) - eps/2 |cof(F) E|^2

with E = -grad(phi) and the field that does not pass the film's free faces; "thin": E = V/h under the
electrode and nothing else. Stresses are derived by hand, tangents by complex steps.

    python3 verify/coupled_plane.py [--gap G] [elements through the film, even, as 4,8,12] [voltages]

prints the tip's lift, the place of the lower electrode's edge and the excess of the capacitance at rest. --gap:
the plate begins G times the film's thickness behind the electrode's edge.
"""
import sys

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

MM = 1e-3
LENGTH = {"a": 3.75 * MM, "b": 15 * MM, "t": 0.1 * MM, "gap": 0.0}
L = 1.5                                     # pre-stretch
H = 0.1 * MM / L**2
YEOH = (178.4e3, -6e3, 4.2e3)
EPS = 2.8 * 8.8541878128e-12
YOUNG, NU = 2950e6, 0.38
BULK = 1e5 * 2 * YEOH[0]


def graded(length, first, last, widest, ratio=1.6):
    """Cuts of [0, length] with elements of about first and last at the ends, growing by `ratio`."""
    left, right = [0.0], [length]
    sizes = [first, last]
    while right[-1] - left[-1] > 1e-15 * length:
        side = 0 if sizes[0] <= sizes[1] else 1
        room = right[-1] - left[-1]
        if room <= 1.5 * sizes[side]:
            break
        if side == 0:
            left.append(left[-1] + sizes[0])
        else:
            right.append(right[-1] - sizes[1])
        sizes[side] = min(sizes[side] * ratio, widest)
    return np.array(left + right[::-1])


def through_film(count):
    """Cuts of the film, finer towards both faces by a factor of about 2 an element."""
    half = count // 2
    size = 2.0 ** np.arange(half)
    cuts = np.concatenate([[0], np.cumsum(size)]) / size.sum() * 0.5
    return (np.concatenate([cuts, 1 - cuts[-2::-1]]) - 0.5) * H


class Mesh:
    """Film and plate of one structured mesh of biquadratic elements."""

    def __init__(self, count, plate=True):
        a, b = LENGTH["a"], LENGTH["b"]
        film = through_film(count)
        fine = film[1] - film[0]
        p = a + LENGTH["gap"]                   # where the plate begins
        x = graded(a, 20 * H, fine, a / 15)
        if p > a:
            x = np.concatenate([x, (a + graded(p - a, fine, fine, b))[1:]])
        x = np.concatenate([x, (p + graded(b - p, fine, 40 * H, b / 40))[1:]])
        z = np.concatenate([film, H / 2 + np.array([0.25, 0.5, 0.75, 1]) * LENGTH["t"]])
        self.columns, self.rows, film_rows = len(x) - 1, len(z) - 1, count
        mid = lambda c: np.sort(np.concatenate([c, 0.5 * (c[1:] + c[:-1])]))
        X, Z = mid(x), mid(z)
        number = np.arange(len(X) * len(Z)).reshape(len(X), len(Z))
        quads, is_film, under = [], [], []
        for i in range(self.columns):
            for k in range(self.rows):
                if k >= film_rows and (not plate or x[i] < p * (1 - 1e-12)):
                    continue
                quads.append(number[2 * i:2 * i + 3, 2 * k:2 * k + 3].ravel())
                is_film.append(k < film_rows)
                under.append(x[i + 1] <= a * (1 + 1e-12))
        quads = np.array(quads)
        used = np.unique(quads)
        new = -np.ones(number.size, int)
        new[used] = np.arange(used.size)
        self.quads = new[quads]
        self.is_film, self.under = np.array(is_film), np.array(under)
        self.x = np.column_stack([np.repeat(X, len(Z)), np.tile(Z, len(X))])[used]
        self.nodes = used.size


def shapes():
    """N, dN/dxi, dN/deta of nine nodes at 3 x 3 Gauss points, and weights."""
    g, w = np.polynomial.legendre.leggauss(3)
    line = lambda s: np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2])
    slope = lambda s: np.array([s - 0.5, -2 * s, s + 0.5])
    B, weight, place = [], [], []
    for i in range(3):
        for k in range(3):
            B.append([np.outer(slope(g[i]), line(g[k])).ravel(), np.outer(line(g[i]), slope(g[k])).ravel()])
            weight.append(w[i] * w[k])
            place.append([1, g[i], g[k]])
    return np.array(B), np.array(weight), np.array(place)


class Problem:
    def __init__(self, mesh, coupled):
        self.m, self.coupled = mesh, coupled
        m = mesh
        elements = len(m.quads)
        B, w, self.P = shapes()
        corner = m.x[m.quads]
        size = corner[:, 8] - corner[:, 0]   # rectangles
        self.grad = B[None] * (2 / size)[:, None, :, None]          # [e, gauss, 2, 9]
        self.dV = w[None] * (0.25 * size.prod(axis=1))[:, None]
        self.pressure = 3 * m.nodes + 3 * np.arange(elements)[:, None] + np.arange(3)[None]
        self.dofs = 3 * m.nodes + 3 * elements
        self.at = np.concatenate([3 * m.quads, 3 * m.quads + 1, 3 * m.quads + 2, self.pressure], axis=1)
        self.u, self.V = np.zeros(self.dofs), 0.0
        x, z = m.x.T
        a, b = LENGTH["a"], LENGTH["b"]
        tol = 1e-9 * b
        held = np.zeros(self.dofs, bool)
        held[0:3 * m.nodes:3] |= (x < tol) | (x > b - tol)
        held[1:3 * m.nodes:3] |= x > b - tol
        self.top = (np.abs(z - H / 2) < 1e-9 * H) & (x <= a + tol)
        self.bottom = (np.abs(z + H / 2) < 1e-9 * H) & (x <= a + tol)
        touched = np.zeros(m.nodes, bool)
        if coupled:
            touched[m.quads[m.is_film].ravel()] = True
        held[2:3 * m.nodes:3] |= self.top | self.bottom | ~touched
        held[self.pressure[~m.is_film].ravel()] = True
        self.free = np.where(~held)[0]
        self.tip = np.argmin(np.hypot(x - a - LENGTH["gap"], z - H / 2))
        self.edge = np.argmin(np.hypot(x - a, z + H / 2))     # of the lower electrode
        # the film is free of stress across its plane: p at rest
        I1 = 2 * L**2 + L**-4
        self.u[self.pressure[m.is_film, 0]] = -2 * self.yeoh(I1) * L**-4

    @staticmethod
    def yeoh(I1):
        i = I1 - 3
        return YEOH[0] + 2 * YEOH[1] * i + 3 * YEOH[2] * i * i

    def stress(self, q, E0):
        """q: F_xx F_xz F_zx F_zz phi_x phi_z p, last axis 7. Derivatives of the energy by them."""
        Fxx, Fxz, Fzx, Fzz, gx, gz, p = np.moveaxis(q, -1, 0)
        out = np.empty_like(q)
        film = self.m.is_film[:, None]
        J = Fxx * Fzz - Fxz * Fzx
        # film
        I1 = L**2 * (Fxx**2 + Fzx**2) + L**2 + L**-4 * (Fxz**2 + Fzz**2)
        W1 = self.yeoh(I1)
        Ex, Ez = -gx, -gz + E0[:, None]
        # cof F E, plane strain: cof = [[Fzz, -Fzx], [-Fxz, Fxx]]
        wx, wz = Fzz * Ex - Fzx * Ez, -Fxz * Ex + Fxx * Ez
        eps = EPS * film
        out[..., 0] = np.where(film, 2 * W1 * L**2 * Fxx + p * Fzz - eps * wz * Ez, 0)
        out[..., 1] = np.where(film, 2 * W1 * L**-4 * Fxz - p * Fzx + eps * wz * Ex, 0)
        out[..., 2] = np.where(film, 2 * W1 * L**2 * Fzx - p * Fxz + eps * wx * Ez, 0)
        out[..., 3] = np.where(film, 2 * W1 * L**-4 * Fzz + p * Fxx - eps * wx * Ex, 0)
        out[..., 4] = eps * (wx * Fzz - wz * Fxz)
        out[..., 5] = eps * (-wx * Fzx + wz * Fxx)
        out[..., 6] = np.where(film, J - 1 - p / BULK, 0)
        # plate: mu/2 (I1 - 3 - 2 ln J) + lambda/2 ln^2 J
        mu, lam = YOUNG / 2 / (1 + NU), YOUNG * NU / (1 + NU) / (1 - 2 * NU)
        s = (lam * np.log(J) - mu) / J
        for k, (f, c) in enumerate([(Fxx, Fzz), (Fxz, -Fzx), (Fzx, -Fxz), (Fzz, Fxx)]):
            out[..., k] = np.where(film, out[..., k], mu * f + s * c)
        return out

    def points(self, u):
        e = u[self.at]
        g = self.grad
        q = np.empty(g.shape[:2] + (7,), complex)
        for i, part in enumerate((slice(0, 9), slice(9, 18), slice(18, 27))):
            d = np.einsum("egjn,en->egj", g, e[:, part])
            q[..., 2 * i:2 * i + 2] = d
        q[..., 0] += 1
        q[..., 3] += 1
        q[..., 6] = e[:, 27:] @ self.P.T
        return q

    def solve(self, V, steps=12):
        """Newton's method at a voltage V."""
        E0 = np.zeros(len(self.m.quads))
        phi = 3 * np.arange(self.m.nodes) + 2
        if self.coupled:
            self.u[phi[self.top]], self.u[phi[self.bottom]] = -V / 2, V / 2
        else:
            E0[self.m.is_film & self.m.under] = V / H
        e, G = self.at.shape
        B = np.zeros((e, 9, 7, G))                   # q = B dofs
        for i in range(3):
            for j in range(2):
                B[:, :, 2 * i + j, 9 * i:9 * i + 9] = self.grad[:, :, j]
        B[:, :, 6, 27:] = self.P[None]
        small = 1e-30
        scale = np.ones(self.dofs)
        scale[phi] = np.sqrt(YEOH[0] / EPS)
        scale[3 * self.m.nodes:] = YEOH[0] / H
        for _ in range(steps):
            q = self.points(self.u)
            if not (np.isfinite(q).all() and (q[..., 0] * q[..., 3] - q[..., 1] * q[..., 2]).real.min() > 0):
                break
            S = self.stress(q, E0).real
            D = np.empty(S.shape + (7,))
            for k in range(7):
                turned = q.copy()
                turned[..., k] += 1j * small
                D[..., k] = self.stress(turned, E0).imag / small
            K = np.einsum("egiG,egik,eg,egkH->eGH", B, D, self.dV, B, optimize=True)
            R = np.einsum("egiG,egi,eg->eG", B, S, self.dV)
            du = self.newton_step(K, R, scale[:3 * self.m.nodes])
            moved = np.abs(du).max() / H
            if moved < 1e-9:
                return self.u[3 * self.tip + 1]
        raise ArithmeticError(f"no equilibrium at {V} V")

    def newton_step(self, K, R, scale):
        """Adds Newton's step; the pressure goes out element by element. Returns it over `scale`."""
        m = self.m
        Kup, Kpp = K[:, :27, 27:], K[:, 27:, 27:].copy()
        Kpp[~m.is_film] = np.eye(3)
        inv = np.linalg.solve(Kpp, np.concatenate([K[:, 27:, :27], R[:, 27:, None]], axis=2))
        inv[~m.is_film] = 0
        K = K[:, :27, :27] - Kup @ inv[:, :, :27]
        at, count = self.at[:, :27], 3 * m.nodes
        r, du = np.zeros(count), np.zeros(count)
        np.add.at(r, at, R[:, :27] - np.einsum("eij,ej->ei", Kup, inv[:, :, 27]))
        rows, cols = np.repeat(at, 27, axis=1).ravel(), np.tile(at, (1, 27)).ravel()
        K = sp.csc_matrix((K.ravel(), (rows, cols)), shape=(count, count))
        f = self.free[self.free < count]
        d = sp.diags(scale[f])
        # displacements make it positive, the potential negative definite: any pivot will do
        factor = splu((d @ K[f][:, f] @ d).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                      options={"SymmetricMode": True})
        du[f] = scale[f] * factor.solve(-scale[f] * r[f])
        self.u[:count] += du
        dp = -inv[:, :, 27] - np.einsum("eij,ej->ei", inv[:, :, :27], du[at])
        self.u[self.pressure[m.is_film]] += dp[m.is_film]
        return du / scale

    def go(self, V):
        """To a voltage from that of the last equilibrium, in steps where Newton's method needs them."""
        at, step = self.V, V - self.V
        while at != V:
            before = self.u.copy()
            try:
                lift = self.solve(at + step)
                at = at + step if abs(V - at - step) > 1e-9 else V
                step = V - at if abs(V - at) < 2 * abs(step) else 2 * step
            except ArithmeticError:
                self.u, step = before, step / 2
                if abs(step) < 5:
                    raise
        self.V = V
        return lift

    def capacitance(self, V):
        """C/C0, C0 = eps a/h, from the field's energy at the state that is there."""
        q = self.points(self.u).real
        Fxx, Fxz, Fzx, Fzz, gx, gz, _ = np.moveaxis(q, -1, 0)
        w2 = (-Fzz * gx + Fzx * gz)**2 + (Fxz * gx - Fxx * gz)**2
        return (self.dV * w2)[self.m.is_film].sum() / V**2 * H / LENGTH["a"]


def creep(V):
    """By how much the lower electrode's edge moves outwards where the mesh at it is e = 2.718 times as fine,
    by theory of small displacements on the stretched half-plane (docs/theory/coupled.md)."""
    I1 = 2 * L**2 + L**-4
    i, a, b = I1 - 3, L**2, L**-4
    G, d = 2 * Problem.yeoh(I1), 4 * (2 * YEOH[1] + 6 * YEOH[2] * i) * (a - b)
    m2 = np.roots([G * b, -(G * (a + b) + d * (a - b)), G * a])
    m = np.sqrt(m2)
    normal = m * (2 * G * b - d * b + G * a + d * a - G * b * m2)
    A = np.linalg.solve(np.array([G * b * (m2 + 1), normal]), [1.0, 1.0])
    return EPS * V**2 / (4 * H) / np.pi * (m @ A)


def main():
    words = sys.argv[1:]
    if words[:1] == ["--gap"]:
        LENGTH["gap"] = float(words[1]) * H
        words = words[2:]
    counts = [int(w) for w in words[0].split(",")] if words else [4, 8, 12, 16]
    for count in counts:
        mesh = Mesh(count)
        thin, coupled = Problem(mesh, False), Problem(mesh, True)
        coupled.solve(0)
        coupled.solve(1e-3)
        excess = (coupled.capacitance(1e-3) - 1) * LENGTH["a"] / H
        first = np.diff(through_film(count))[0]
        print(f"{count} elements through the film, the first h/{H / first:.0f}, {mesh.nodes} nodes; "
              f"capacitance in excess at rest, over h/a: {excess:.5f}, exact {np.log(4) / 2 / np.pi:.5f}")
        for V in [float(v) for v in words[1:]] or [100.0]:
            z = thin.go(V), coupled.go(V)
            print(f"  {V:g} V: tip {1e6 * z[0]:.7f} um (V/h), {1e6 * z[1]:.7f} um (coupled): "
                  f"{100 * (z[1] / z[0] - 1):+.4f} %; edge of the lower electrode "
                  f"{1e6 * coupled.u[3 * coupled.edge]:.5f} um, by theory {1e6 * creep(V):.5f} um more for each e "
                  f"finer", flush=True)


if __name__ == "__main__":
    main()
