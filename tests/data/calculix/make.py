#!/usr/bin/env python3
"""Solves two parts with CalculiX and writes what tests/physics/calculix.rs compares with: decks and results.csv.

Usage, from this folder, with CalculiX 2.20 (Debian: calculix-ccx):

    python3 make.py

The meshes are those of the scenes `clip` and `bracket` (assets/meshes). CalculiX expands CPS6 and CPE6 into wedges; its law at
finite strain is Saint-Venant-Kirchhoff's, which agrees with the corotated law to the order of the strain. A wedge as thick as its
part has shear across its thickness (11 % stiffer for `clip` at 10 mm), plane stress has none: thickness and force are divided by 1000.
"""

import csv
import math
import subprocess
from pathlib import Path

# What thickness and force are divided by.
THIN = 1000.0

HERE = Path(__file__).resolve().parent
MESHES = HERE.parents[2] / "assets" / "meshes"

PARTS = [
    {
        "name": "clip",
        "scale": 1e-3,
        "young": 2.8e9,
        "poisson": 0.35,
        "thickness": 0.003,
        "element": "CPS6",
        "clamp": "base",
        "loaded": "nose",
        "force": [0.0, -2.0],
        "watched": (-5.0, 0.0),
    },
    {
        "name": "bracket",
        "scale": 1.0,
        "young": 2.0e6,
        "poisson": 0.45,
        "thickness": 0.2,
        "element": "CPE6",
        "clamp": "wall",
        "loaded": "end",
        "force": [0.0, -200.0],
        "watched": (0.306834815, 0.448236191),
    },
]


def read_msh(path):
    """Nodes {tag: (x, y)}, triangles [(tag, nodes)], edges {physical name: [nodes of each side]} of an MSH 4.1 ASCII file."""
    lines = iter(path.read_text().split("\n"))
    names, entity_names, nodes, triangles, edges = {}, {}, {}, [], {}
    for line in lines:
        if line == "$PhysicalNames":
            for _ in range(int(next(lines))):
                dim, tag, name = next(lines).split(maxsplit=2)
                names[int(dim), int(tag)] = name.strip('"')
        elif line == "$Entities":
            points, curves, surfaces, _ = map(int, next(lines).split())
            for _ in range(points):
                next(lines)
            for dim, count in ((1, curves), (2, surfaces)):
                for _ in range(count):
                    fields = next(lines).split()
                    physical = int(fields[7])
                    if physical:
                        entity_names[dim, int(fields[0])] = names[dim, int(fields[8])]
        elif line == "$Nodes":
            for _ in range(int(next(lines).split()[0])):
                count = int(next(lines).split()[3])
                tags = [int(next(lines)) for _ in range(count)]
                for tag in tags:
                    nodes[tag] = tuple(map(float, next(lines).split()[:2]))
        elif line == "$Elements":
            for _ in range(int(next(lines).split()[0])):
                dim, entity, _, count = map(int, next(lines).split())
                for _ in range(count):
                    tag, *of = map(int, next(lines).split())
                    if dim == 2:
                        triangles.append((tag, of))
                    elif (dim, entity) in entity_names:
                        edges.setdefault(entity_names[dim, entity], []).append(of)
    return nodes, triangles, edges


def edge_shares(nodes, sides):
    """Share of a uniform traction at each node of straight quadratic sides: 1/6, 1/6 and 4/6 of each side's length."""
    shares = {}
    lengths = [math.dist(nodes[a], nodes[b]) for a, b, _ in sides]
    for (a, b, middle), length in zip(sides, lengths):
        for node, weight in ((a, 1 / 6), (b, 1 / 6), (middle, 4 / 6)):
            shares[node] = shares.get(node, 0.0) + weight * length / sum(lengths)
    return shares


def deck(part, nonlinear):
    nodes, triangles, edges = read_msh(MESHES / f"{part['name']}.msh")
    scale = part["scale"]
    out = [f"** {part['name']}, {'large displacements' if nonlinear else 'linear'}; made by make.py", "*NODE, NSET=ALL"]
    out += [f"{tag}, {x * scale:.12e}, {y * scale:.12e}, 0" for tag, (x, y) in sorted(nodes.items())]
    out.append(f"*ELEMENT, TYPE={part['element']}, ELSET=BODY")
    out += [", ".join(map(str, [tag, *of])) for tag, of in triangles]
    clamped = sorted({n for side in edges[part["clamp"]] for n in side})
    shares = edge_shares(nodes, edges[part["loaded"]])
    out.append("*NSET, NSET=CLAMP")
    out += [f"{n}," for n in clamped]
    out.append("*NSET, NSET=LOADED")
    out += [f"{n}," for n in sorted(shares)]
    out += ["*MATERIAL, NAME=LAW", "*ELASTIC", f"{part['young']:.12g}, {part['poisson']:.12g}"]
    out += ["*SOLID SECTION, ELSET=BODY, MATERIAL=LAW", f"{part['thickness'] / THIN:.12g}"]
    out += ["*BOUNDARY", "CLAMP, 1, 2"]
    out += ["*STEP, NLGEOM, INC=1000" if nonlinear else "*STEP", "*STATIC", *(["0.1, 1."] if nonlinear else [])]
    out.append("*CLOAD")
    for node, share in sorted(shares.items()):
        out += [f"{node}, {axis + 1}, {f * share / THIN:.12g}" for axis, f in enumerate(part["force"]) if f]
    out += ["*NODE PRINT, NSET=LOADED", "U", "*NODE FILE, OUTPUT=2D, NSET=ALL", "U", "*EL FILE, OUTPUT=2D", "S", "*END STEP", ""]
    return "\n".join(out), shares, nodes


def last_frd_block(path, name):
    """{node: values} of the last block of a name in a CalculiX .frd file."""
    result, reading = {}, False
    for line in path.read_text().split("\n"):
        if line.startswith(f" -4  {name}"):
            result, reading = {}, True
        elif reading and line.startswith(" -1"):
            node = int(line[3:13])
            result[node] = [float(line[13 + 12 * i : 25 + 12 * i]) for i in range((len(line) - 13) // 12)]
        elif reading and line.startswith(" -3"):
            reading = False
    return result


def solve(part, nonlinear):
    name = f"{part['name']}-{'large' if nonlinear else 'linear'}"
    text, shares, nodes = deck(part, nonlinear)
    (HERE / f"{name}.inp").write_text(text)
    subprocess.run(["ccx", name], cwd=HERE, check=True, stdout=subprocess.DEVNULL)
    u = last_frd_block(HERE / f"{name}.frd", "DISP")
    s = last_frd_block(HERE / f"{name}.frd", "STRESS")
    probe = [sum(share * u[n][axis] for n, share in shares.items()) for axis in range(2)]

    def von_mises(v):
        xx, yy, zz, xy, yz, zx = v
        return math.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))

    at = min(s, key=lambda n: math.dist(nodes[n], part["watched"]))
    for leftover in HERE.glob(f"{name}.*"):
        if leftover.suffix != ".inp":
            leftover.unlink()
    (HERE / "spooles.out").unlink(missing_ok=True)
    return [part["name"], "newton" if nonlinear else "linear", *probe, *nodes[at], von_mises(s[at])]


with open(HERE / "results.csv", "w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["scene", "method", "ux_m", "uy_m", "x", "y", "von_mises_pa"])
    for part in PARTS:
        for nonlinear in (False, True):
            row = solve(part, nonlinear)
            table.writerow(row[:2] + [f"{v:.9g}" for v in row[2:]])
