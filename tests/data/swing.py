"""The trajectory of the swing's tip, computed independently of this project: explicit Verlet steps with the consistent mass.

Needs numpy and scipy:  python3 swing.py > swing.csv
The beam of assets/scenes/swing.toml: 20 x 1 cells of six-node triangles, corotational energy with a rotation a quadrature
point, released from horizontal under its weight. Two step sizes; their difference is the error of the finer one times three.
"""

import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

L, H, NX = 1.0, 0.1, 20
E, NU, RHO, G = 1e6, 0.3, 1000.0, 9.81
LAMBDA, MU = E * NU / (1 - NU**2), E / (2 * (1 + NU))  # plane stress, thickness 1 m


def mesh():
    number, points, triangles = {}, [], []

    def node(i, j):
        """The node at the half-cell (i, j)."""
        if (i, j) not in number:
            number[i, j] = len(points)
            points.append((L * i / (2 * NX), H * (j / 2 - 0.5)))
        return number[i, j]

    def triangle(a, b, c):
        half = lambda p, q: ((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)
        triangles.append([node(*p) for p in (a, b, c, half(a, b), half(b, c), half(c, a))])

    for i in range(NX):
        ll, lr, ul, ur = (2 * i, 0), (2 * i + 2, 0), (2 * i, 2), (2 * i + 2, 2)
        if i % 2 == 0:
            triangle(ll, lr, ur), triangle(ll, ur, ul)
        else:
            triangle(ll, lr, ul), triangle(lr, ur, ul)
    return np.array(points), np.array(triangles)


def shape(b, c):
    a = 1 - b - c
    n = np.array([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a])
    d = np.array([[1 - 4 * a, 1 - 4 * a], [4 * b - 1, 0], [0, 4 * c - 1],
                  [4 * (a - b), -4 * b], [4 * c, 4 * b], [-4 * c, 4 * (a - c)]])
    return n, d


X, T = mesh()
n_nodes = len(X)
# Quadrature points of the stiffness: gradients and areas.
gradients, areas = [], []
for point in [(1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)]:
    _, d = shape(*point)
    jacobian = np.einsum("eai,ak->eik", X[T], d)
    gradients.append(np.einsum("ak,eki->eai", d, np.linalg.inv(jacobian)))
    areas.append(np.linalg.det(jacobian) / 6)

# Mass: Gauss on a collapsed square, exact to degree 6.
mass = np.zeros((len(T), 6, 6))
weight = np.zeros((len(T), 6))
x, w = np.polynomial.legendre.leggauss(4)
for xi, wi in zip((x + 1) / 2, w / 2):
    for eta, we in zip((x + 1) / 2, w / 2):
        n, d = shape(xi, eta * (1 - xi))
        area = np.linalg.det(np.einsum("eai,ak->eik", X[T], d)) * wi * we * (1 - xi)
        mass += RHO * area[:, None, None] * np.outer(n, n)
        weight += RHO * area[:, None] * n
rows, cols = np.repeat(T, 6, axis=1).ravel(), np.tile(T, (1, 6)).ravel()
M = coo_matrix((mass.ravel(), (rows, cols)), (n_nodes, n_nodes)).tocsc()
free = np.flatnonzero(X[:, 0] > 1e-12)
solve = splu(M[free][:, free]).solve
gravity = np.zeros((n_nodes, 2))
np.add.at(gravity[:, 1], T, -G * weight)


def force(u):
    f = gravity.copy()
    for g, a in zip(gradients, areas):
        F = np.eye(2) + np.einsum("eai,eak->eik", u[T], g)
        c, s = F[:, 0, 0] + F[:, 1, 1], F[:, 1, 0] - F[:, 0, 1]
        h = np.hypot(c, s)
        R = np.array([[c / h, -s / h], [s / h, c / h]]).transpose(2, 0, 1)
        S = np.einsum("eki,ekj->eij", R, F)
        strain = 0.5 * (S + S.transpose(0, 2, 1)) - np.eye(2)
        stress = 2 * MU * strain + LAMBDA * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(2)
        P = np.einsum("eij,ejk->eik", R, stress) * a[:, None, None]
        np.subtract.at(f, T, np.einsum("eik,eak->eai", P, g))
    return f


def trajectory(steps_per_sample, samples=480, rate=240):
    dt = 1 / (rate * steps_per_sample)
    tip = np.flatnonzero(X[:, 0] > L - 1e-12)
    tip_weight = np.where(np.abs(X[tip, 1]) < 1e-12, 4 / 6, 1 / 6)
    u, v, out = np.zeros((n_nodes, 2)), np.zeros((n_nodes, 2)), []
    a = np.zeros_like(u)
    a[free] = solve(force(u)[free])
    for _ in range(samples):
        for _ in range(steps_per_sample):
            v += 0.5 * dt * a
            u += dt * v
            a[free] = solve(force(u)[free])
            v += 0.5 * dt * a
        out.append(tip_weight @ u[tip])
    return np.array(out)


if __name__ == "__main__":
    coarse, fine = trajectory(40), trajectory(80)
    print("# Tip displacement of the swing, m, computed independently of this code (swing.py): explicit Verlet steps of 1/19200 s.")
    print(f"# Steps of twice the length end {np.abs(fine - coarse).max():.1e} m away at most.")
    print("time,tip_x,tip_y")
    for i, (ux, uy) in enumerate(fine):
        print(f"{(i + 1) / 240:.10f},{ux:.10f},{uy:.10f}")
    print(f"largest difference {np.abs(fine - coarse).max():.2e}", file=sys.stderr)
