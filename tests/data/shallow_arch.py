"""Limit load of the clamped shallow arch of assets/scenes/snap.toml under a force in its middle, N, and the displacement of
its middle there, m, computed independently of this project:  python3 shallow_arch.py

Beam theory of small slopes, EI w'''' + N (w'' - 1/R) = -P delta, with the thrust N = EI k^2 from the shortening of the axis.
For every k the deflection is linear in P, and the shortening gives a quadratic equation for P.
"""

from math import cos, sin, sqrt


def solve(matrix, right):
    """Solves a small system by Gauss's elimination with pivots."""
    n = len(matrix)
    rows = [[*matrix[i], right[i]] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(n):
            if r != i:
                factor = rows[r][i] / rows[i][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    return [rows[i][n] / rows[i][i] for i in range(n)]


def limit(length, rise, bending, stiffness):
    points, half, curvature = 400, 0.5 * length, 8.0 * rise / length**2
    best = [0.0, 0.0]
    for i in range(1, 2000):
        k = i * 8.9 / (2000.0 * length)
        s, c = sin(k * half), cos(k * half)
        # w = a + b x + c cos kx + d sin kx + x^2/2R; w = w' = 0 at the clamp, w' = 0 and EI w''' = P/2 in the middle.
        conditions = [[1, 0, 1, 0], [0, 1, 0, k], [0, 1, -k * s, k * c], [0, 0, k**3 * s, -(k**3) * c]]
        alone = solve(conditions, [0.0, 0.0, -curvature * half, 0.0])
        unit = solve(conditions, [0.0, 0.0, 0.0, 0.5 / bending])
        slope = lambda v, x: v[1] - v[2] * k * sin(k * x) + v[3] * k * cos(k * x)
        q = [bending * k * k * length / stiffness, 0.0, 0.0]
        for j in range(points):
            x = half * (j + 0.5) / points
            rest = 4.0 * rise / length * (1.0 - 2.0 * x / length)
            a, b = slope(alone, x) + curvature * x, slope(unit, x)
            weight = length / points
            q[0] += weight * (rest * a + 0.5 * a * a)
            q[1] += weight * (rest * b + a * b)
            q[2] += weight * 0.5 * b * b
        root = q[1] ** 2 - 4.0 * q[2] * q[0]
        for sign in [1.0, -1.0] if root >= 0.0 else []:
            force = (-q[1] + sign * sqrt(root)) / (2.0 * q[2])
            middle = lambda v: v[0] + v[1] * half + v[2] * c + v[3] * s
            increment = -(middle(alone) + 0.5 * curvature * half**2 + force * middle(unit))
            # Only states count in which the crown is above the ends.
            if force > best[0] and 0.0 <= increment < rise:
                best = [force, increment]
    return best


young, height, thickness = 210e9, 0.001, 0.02
print(*limit(0.2, 0.008, young * thickness * height**3 / 12.0, young * thickness * height))
