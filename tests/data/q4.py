"""Stiffness of one quadrilateral of Taylor, Beresford and Wilson in its textbook form, computed independently of this project:
3 x 12 strain matrices at 2 x 2 points, gradients of modes scaled with the ratio of the Jacobians, and the last four unknowns
condensed. E = 100, nu = 0.3, t = 0.5.

python3 q4.py > q4.csv: eight rows in plane stress, and eight in plane strain.
"""

from math import sqrt

# Far from a parallelogram.
NODES = [[0.1, -0.2], [2.0, 0.3], [1.5, 1.4], [-0.3, 1.0]]
CORNERS = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
YOUNG, POISSON, THICKNESS = 100.0, 0.3, 0.5


def local(a, b, xi, eta):
    return [0.25 * a * (1.0 + b * eta), 0.25 * b * (1.0 + a * xi)]


def jacobian(xi, eta):
    gradients = [local(a, b, xi, eta) for a, b in CORNERS]
    return [[sum(g[i] * x[j] for g, x in zip(gradients, NODES)) for j in range(2)] for i in range(2)]


def determinant(m):
    return m[0][0] * m[1][1] - m[0][1] * m[1][0]


def applied_inverse(m, v):
    d = determinant(m)
    return [(m[1][1] * v[0] - m[0][1] * v[1]) / d, (m[0][0] * v[1] - m[1][0] * v[0]) / d]


def stiffness(elasticity):
    centre, all_ = jacobian(0.0, 0.0), [[0.0] * 12 for _ in range(12)]
    for xi, eta in [[p / sqrt(3.0), q / sqrt(3.0)] for p, q in CORNERS]:
        j = jacobian(xi, eta)
        ratio = determinant(centre) / determinant(j)
        gradients = [applied_inverse(j, local(a, b, xi, eta)) for a, b in CORNERS]
        gradients += [[ratio * g for g in applied_inverse(centre, m)] for m in ([-2.0 * xi, 0.0], [0.0, -2.0 * eta])]
        strain = [[0.0] * 12 for _ in range(3)]
        for a, (x, y) in enumerate(gradients):
            strain[0][2 * a], strain[1][2 * a + 1] = x, y
            strain[2][2 * a], strain[2][2 * a + 1] = y, x
        weight = THICKNESS * determinant(j)
        for i in range(12):
            for k in range(12):
                terms = (strain[r][i] * elasticity[r][s] * strain[s][k] for r in range(3) for s in range(3))
                all_[i][k] += weight * sum(terms)
    for c in reversed(range(8, 12)):
        for i in range(c):
            factor = all_[i][c] / all_[c][c]
            for k in range(c):
                all_[i][k] -= factor * all_[c][k]
    return [row[:8] for row in all_[:8]]


plane_stress = YOUNG / (1.0 - POISSON**2)
plane_strain = YOUNG / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
shear = YOUNG / (2.0 * (1.0 + POISSON))
for size, along, across in [[plane_stress, 1.0, POISSON], [plane_strain, 1.0 - POISSON, POISSON]]:
    for row in stiffness([[size * along, size * across, 0.0], [size * across, size * along, 0.0], [0.0, 0.0, shear]]):
        print(",".join(map(repr, row)))
