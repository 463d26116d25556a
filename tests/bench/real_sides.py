#!/usr/bin/env python3
"""Clouds of public files without anything but places, which way they face in truth, and how many
points of a bake do. See sides_table.sh and README.md.

  real_sides.py make FILE PREFIX UP KIND [ARGUMENT]...   FILE as its origin has it, or as PLY
  real_sides.py score PREFIX LIT                         percent of the points whose truth is known

make writes PREFIX.ply, x y z alone; PREFIX.truth.npz, of each point a way that its front looks to,
or zeros where that is not known; and PREFIX.lights, of each light its name and how a bake gets it.
"""
import sys

import numpy as np

TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
         "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
         "float": "f4", "float32": "f4", "double": "f8", "float64": "f8"}

# Normals of planes that are fitted to noisy points are some degrees off: what is seen at less than
# about three of them, by this sine, may be turned right and still look away from the scanner.
SINE_LEAST = 0.05
# Ground that is steeper than this, by the height of a unit normal, is a wall, which faces anywhere.
LEVEL = 0.3
# Points of a scan that lie on its mesh, in widths of the mesh: its points are 0.001 to 0.002 apart.
ON_MESH = 0.01


# ------------------------------------------------------------------------------------------ files

def read_header(data):
    """Format and elements, each its name, its count and the words of its properties; length."""
    end = data.index(b"\n", data.index(b"end_header")) + 1
    form, elements = None, []
    for words in (line.split() for line in data[:end].decode("latin1").split("\n")):
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    return form, elements, end


class Numbers:
    """The numbers of a PLY file's body, one after the other."""

    def __init__(self, form, body):
        self.order = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[form]
        self.body, self.at = (body if self.order else body.split()), 0

    def take(self, kind, count=1):
        if not self.order:
            taken = [float(word) for word in self.body[self.at:self.at + count]]
            self.at += count
            return taken
        kind = np.dtype(self.order + TYPES[kind])
        taken = np.frombuffer(self.body, kind, count, self.at)
        self.at += count * kind.itemsize
        return taken

    def rows(self, count, properties):
        """Of single numbers in a table."""
        if not self.order:
            return np.array(self.take("float", count * len(properties))).reshape(count, -1)
        kind = np.dtype([(p[1], self.order + TYPES[p[0]]) for p in properties])
        table = np.frombuffer(self.body, kind, count, self.at)
        self.at += count * kind.itemsize
        return np.stack([table[p[1]].astype(float) for p in properties], 1)


def read_ply(path):
    """Vertices as a dictionary of columns, and lists of the element behind them."""
    data = open(path, "rb").read()
    form, elements, length = read_header(data)
    numbers = Numbers(form, data[length:])
    _, count, properties = elements[0]
    table = numbers.rows(count, properties)
    columns = {p[-1]: table[:, i] for i, p in enumerate(properties)}
    lists = []
    if len(elements) > 1 and elements[1][2][0][0] == "list":
        for _ in range(elements[1][1]):
            for p in elements[1][2]:
                size = int(numbers.take(p[1] if p[0] == "list" else p[0])[0])
                row = numbers.take(p[2], size) if p[0] == "list" else []
                if p is elements[1][2][0]:
                    lists.append([int(i) for i in row])
    return columns, lists


def places_of(columns):
    return np.stack([columns[c] for c in "xyz"], 1)


def triangles_of_strip(strip):
    """Strips end with a negative number; every second triangle turns the other way."""
    triangles, first = [], 0
    for i, vertex in enumerate(strip):
        if vertex < 0:
            first = i + 1
        elif i - first >= 2:
            a, b, c = strip[i - 2:i + 1]
            triangles.append((a, b, c) if (i - first) % 2 == 0 else (b, a, c))
    return triangles


def read_mesh(path):
    """Places of the vertices, and triangles as the file turns them."""
    if path.endswith(".obj"):
        return read_obj(path)
    columns, lists = read_ply(path)
    triangles = []
    for face in lists:
        if len(lists) == 1:
            triangles = triangles_of_strip(face)
        else:
            triangles += [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]
    return places_of(columns), np.array(triangles)


def read_obj(path):
    places, triangles = [], []
    for words in (line.split() for line in open(path)):
        if words[:1] == ["v"]:
            places.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(word.split("/")[0]) for word in words[1:]]
            face = [i - 1 if i > 0 else len(places) + i for i in face]
            triangles += [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]
    return np.array(places), np.array(triangles)


def write_places(path, places):
    with open(path, "wb") as out:
        out.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(places))
        out.write(b"".join(b"property double %s\n" % c for c in (b"x", b"y", b"z")))
        out.write(b"end_header\n" + places.astype("<f8").tobytes())


# ---------------------------------------------------------------------------------------- meshes

def face_normals(places, triangles):
    """Twice the area long."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def outward(places, triangles):
    """1 where a closed mesh is turned outward, -1 where it is turned inside out."""
    middle = places.mean(0)
    volume = ((places[triangles[:, 0]] - middle) * face_normals(places, triangles)).sum()
    return np.sign(volume)


def vertex_normals(places, triangles):
    normals, faces = np.zeros_like(places), face_normals(places, triangles)
    for k in range(3):
        np.add.at(normals, triangles[:, k], faces)
    return normals


def sample(places, triangles, count):
    """Places evenly on all faces, and their normals."""
    random, faces = np.random.default_rng(1), face_normals(places, triangles)
    area = np.linalg.norm(faces, axis=1)
    chosen = random.choice(len(triangles), count, p=area / area.sum())
    s, t = np.sqrt(random.random((count, 1))), random.random((count, 1))
    a, b, c = (places[triangles[chosen, k]] for k in range(3))
    return (1 - s) * a + s * (1 - t) * b + s * t * c, faces[chosen]


# ----------------------------------------------------------------------------------------- truths
# Each returns places and ways; a point's truth is unknown where its way is 0.

def of_vertices(path):
    """A closed mesh's own points."""
    places, triangles = read_mesh(path)
    return places, vertex_normals(places, triangles) * outward(places, triangles)


def of_faces(path, count):
    places, triangles = read_mesh(path)
    sign = outward(places, triangles)
    places, normals = sample(places, triangles, int(count))
    return places, normals * sign


def of_box(path, count):
    """The Cornell box: its walls face inward and its blocks outward as the file has it. A block's
    underside and the floor are one plane, of which it cannot be seen which is which."""
    places, triangles = read_mesh(path)
    low = places[:, 1].min()
    bottom = (places[triangles][:, :, 1] == low).all(1)
    blocks = triangles[bottom & (face_normals(places, triangles)[:, 1] < 0)]
    spots, normals = sample(places, triangles, int(count))
    for a, b, c in places[blocks][:, :, ::2]:
        inside = (spots[:, 1] == low)
        for p, q in ((a, b), (b, c), (c, a)):
            side = np.cross(q - p, spots[:, ::2] - p) * np.cross(q - p, a + b + c - 3 * p)
            inside &= side >= 0
        normals[inside] = 0
    return spots, normals


def of_normals(path):
    """Normals that came with the file, of a mesh that its authors had."""
    columns, _ = read_ply(path)
    return places_of(columns), np.stack([columns[c] for c in ("nx", "ny", "nz")], 1)


def of_table(path):
    """The same of a table of text, of a closed thing: turned outward all together."""
    table = np.loadtxt(path)
    places, normals = table[:, :3], table[:, 3:6]
    return places, normals * np.sign(((places - places.mean(0)) * normals).sum())


def of_bounds(path):
    """What lies in the planes of the bounds faces out of them; no more is known."""
    places = np.loadtxt(path, skiprows=1)[:, :3]
    ways = np.zeros_like(places)
    for k in range(3):
        for sign in (-1, 1):
            ways[sign * places[:, k] > (sign * places[:, k]).max() - 1e-4, k] = sign
    ways[(ways != 0).sum(1) > 1] = 0
    return places, ways


def of_ellipsoid(path):
    places = places_of(read_ply(path)[0])
    middle = 0.5 * (places.min(0) + places.max(0))
    return places, (places - middle) / np.ptp(places, 0) ** 2


def of_mesh_nearby(path, mesh):
    """A scan of what there is a mesh of, in its frame."""
    places = places_of(read_ply(path)[0])
    vertices, normals = of_vertices(mesh)
    ways = np.zeros_like(places)
    for first in range(0, len(places), 256):
        part = places[first:first + 256]
        squared = ((part[:, None] - vertices[None]) ** 2).sum(2)
        near = squared.min(1) < (ON_MESH * np.ptp(vertices, 0).max()) ** 2
        ways[first:first + 256] = normals[squared.argmin(1)] * near[:, None]
    return places, ways


def of_scanner(path, place):
    """Rows that are all zeros are beams that met nothing."""
    places = places_of(read_ply(path)[0])
    places = places[(places != 0).any(1) & np.isfinite(places).all(1)]
    return places, np.array([float(c) for c in place.split(",")]) - places


def of_view(path, way):
    """Seen from far away, by this way to there."""
    places = places_of(read_ply(path)[0])
    return places, np.array([[float(c) for c in way.split(",")]]).repeat(len(places), 0)


def of_terrain(path, up):
    places = places_of(read_ply(path)[0])
    return places, up_vector(up)[None].repeat(len(places), 0)


KINDS = {"vertices": of_vertices, "faces": of_faces, "box": of_box, "normals": of_normals,
         "table": of_table, "bounds": of_bounds, "ellipsoid": of_ellipsoid,
         "nearby": of_mesh_nearby, "scanner": of_scanner, "view": of_view,
         "terrain": of_terrain}


# ------------------------------------------------------------------------------------------ all

def up_vector(name):
    vector = np.zeros(3)
    vector["xyz".index(name[-1])] = -1 if name[0] == "-" else 1
    return vector


def lights_of(kind, arguments, places, up):
    """Suns 40 degrees from the zenith, from two sides; a sky; and a lamp: where the scanner was,
    in the middle of a box, and else above and aside."""
    low, high = np.percentile(places, [1, 99], axis=0)
    middle, width = 0.5 * (low + high), np.linalg.norm(high - low)
    side = np.roll(up, 1) * 0.7 + np.roll(up, 2) * 0.5
    lamp = middle + width * (0.6 * up + 0.3 * side)
    text = lambda v: ",".join("%.12g" % c for c in v)
    if kind == "scanner":
        lamp = np.array([float(c) for c in arguments[0].split(",")])
    elif kind == "box":
        lamp = middle
    return [("sun", "sun toward %s irradiance 3" % text(-up - side)),
            ("sun2", "sun toward %s irradiance 3" % text(side - up)),
            ("sky", "sky radiance 1"),
            ("lamp", "point at %s intensity %.9g" % (text(lamp), width**2))]


def make(path, prefix, up, kind, *arguments):
    if kind == "terrain":
        arguments = [up]
    places, ways = KINDS[kind](path, *arguments)
    write_places(prefix + ".ply", places)
    np.savez(prefix + ".truth.npz", ways=ways, least=LEVEL if kind == "terrain" else SINE_LEAST)
    with open(prefix + ".lights", "w") as out:
        for name, light in lights_of(kind, arguments, places, up_vector(up)):
            out.write("%s\t%s\n" % (name, light))


def score(prefix, lit):
    """Percent of the points that face as they should. Both files have the same order."""
    columns, _ = read_ply(lit)
    before, truth = places_of(read_ply(prefix + ".ply")[0]), np.load(prefix + ".truth.npz")
    normals, ways = np.stack([columns[c] for c in ("nx", "ny", "nz")], 1), truth["ways"]
    if len(normals) != len(before) or not np.allclose(places_of(columns), before, 1e-6, 1e-6):
        sys.exit("%s: not the points of %s.ply in their order" % (lit, prefix))
    length = np.linalg.norm(ways, axis=1)
    cosine = (normals * ways).sum(1) / np.where(length > 0, length, 1)
    known = (length > 0) & (np.abs(cosine) > truth["least"])
    print("%.2f %d" % (100 * (cosine[known] > 0).mean(), known.sum()))


if __name__ == "__main__":
    {"make": make, "score": score}[sys.argv[1]](*sys.argv[2:])
