# SPDX-License-Identifier: Apache-2.0
# Meshes in pieces for mpi.sh, and the difference of two pictures.
#   pieces.py make CELLS PIECES PARTITION [ARRAYS]: whole.vtu, and lists of pieces: plain.pvtu; ghosts.pvtu, whose pieces have
#   marked copies of their neighbours' cells; unmarked.pvtu, in which nothing tells copies. CELLS: tetrahedra or
#   hexahedra; PARTITION: boxes, or scattered at random; ARRAYS: quantities, groups, of which each has
#   nine, labels, or none.
#   pieces.py differ A.tif B.tif: the largest difference of two pictures of doubles.
import array
import math
import random
import struct
import sys
import zlib

N = 6  # cubes along each axis


def index(i, j, k):
    return i + (N + 1) * (j + (N + 1) * k)


def make(kind, pieces, partition, arrays="quantities"):
    points, values = [], []
    for place in range((N + 1) ** 3):
        x, y, z = (place // (N + 1) ** k % (N + 1) / N for k in range(3))
        points.append((x + 0.04 * math.sin(5 * y + 3 * z), y + 0.04 * math.sin(4 * z + 2 * x),
                       z + 0.04 * math.sin(6 * x + y)))
        values.append(math.sin(6 * x) * math.cos(5 * y) + z * z + x * y)
    cells, cubes = [], []
    for cube in range(N ** 3):
        at = [cube // N ** k % N for k in range(3)]
        a = [index(*(at[k] + (c >> k & 1) for k in range(3))) for c in range(8)]
        if kind == "hexahedra":
            cells.append([a[c] for c in (0, 1, 3, 2, 4, 5, 7, 6)])
        else:
            cells += [[a[0], a[one], a[two], a[7]] for one, two in ((1, 3), (1, 5), (2, 3), (2, 6), (4, 5), (4, 6))]
        cubes += [at] * (1 if kind == "hexahedra" else 6)
    chance = random.Random(1)
    if partition == "boxes":
        owner = [sum((2 * at[k] // N) << k for k in range(3)) % pieces for at in cubes]
    else:
        owner = [chance.randrange(pieces) for _ in cells]

    def write(path, own, copies, marked):
        every = own + copies
        used = sorted({v for c in every for v in cells[c]})
        chance.shuffle(used)  # each piece numbers its points as it likes
        number = {v: i for i, v in enumerate(used)}

        def data(name, kind, values, components=1):
            return '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>\n' % (
                kind, name, components, " ".join(map(str, values)))

        with open(path, "w") as file:
            file.write('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
                       '<Piece NumberOfPoints="%d" NumberOfCells="%d">\n<PointData>' % (len(used), len(every)))
            if arrays == "quantities":
                file.write(data("s", "Float64", (repr(values[v]) for v in used)))
            if arrays == "groups":
                file.write(data("k", "Float64", (repr(abs(values[v]) * (g + 1)) for v in used for g in range(9)), 9))
            file.write("</PointData><CellData>")
            if arrays == "groups":
                file.write(data("j", "Float64", (repr(sum(cubes[c]) - g / 3) for c in every for g in range(9)), 9))
            if arrays == "quantities":
                file.write(data("c", "Float64", (sum(cubes[c]) + 0.5 for c in every)))
            if arrays == "labels":  # of which a piece has some only
                file.write(data("material", "Int32", (sum(cubes[c]) // 3 for c in every)))
            if marked:
                file.write(data("vtkGhostType", "UInt8", [0] * len(own) + [1] * len(copies)))
            file.write("</CellData><Points>" + data("p", "Float64", (repr(x) for v in used for x in points[v]), 3))
            file.write("</Points><Cells>" + data("connectivity", "Int64", (number[v] for c in every for v in cells[c])))
            file.write(data("offsets", "Int64", (len(cells[0]) * (i + 1) for i in range(len(every)))))
            file.write(data("types", "UInt8", [12 if kind == "hexahedra" else 10] * len(every)))
            file.write("</Cells></Piece></UnstructuredGrid></VTKFile>\n")

    write("whole.vtu", list(range(len(cells))), [], False)
    for p in range(pieces):
        own = [c for c in range(len(cells)) if owner[c] == p]
        touched = {v for c in own for v in cells[c]}
        copies = [c for c in range(len(cells)) if owner[c] != p and any(v in touched for v in cells[c])]
        write("plain_%d.vtu" % p, own, [], False)
        write("ghosts_%d.vtu" % p, own, copies, True)
        write("unmarked_%d.vtu" % p, own, copies, False)
    for name in ("plain", "ghosts", "unmarked"):
        with open(name + ".pvtu", "w") as file:
            file.write('<VTKFile type="PUnstructuredGrid" version="0.1"><PUnstructuredGrid GhostLevel="0">')
            for p in range(pieces):
                file.write('<Piece Source="%s_%d.vtu"/>' % (name, p))
            file.write("</PUnstructuredGrid></VTKFile>\n")


def pixels(path):
    """The numbers of a TIFF as this command writes it: strips, compressed by zlib, of doubles."""
    with open(path, "rb") as file:
        data = file.read()
    (at,) = struct.unpack_from("<I", data, 4)
    tags = {}
    for i in range(struct.unpack_from("<H", data, at)[0]):
        tag, kind, count = struct.unpack_from("<HHI", data, at + 2 + 12 * i)
        code, size = {3: ("H", 2), 4: ("I", 4)}.get(kind, ("B", 1))
        place = at + 10 + 12 * i
        if count * size > 4:
            (place,) = struct.unpack_from("<I", data, place)
        tags[tag] = struct.unpack_from("<%d%s" % (count, code), data, place)
    numbers = array.array("d")
    for start, size in zip(tags[273], tags[279]):
        numbers.frombytes(zlib.decompress(data[start:start + size]))
    return numbers


if sys.argv[1] == "make":
    make(sys.argv[2], int(sys.argv[3]), *sys.argv[4:])
else:
    one, other = pixels(sys.argv[2]), pixels(sys.argv[3])
    assert len(one) == len(other) and max(one) > 0.5
    print("%.3g" % max(abs(a - b) for a, b in zip(one, other)))
