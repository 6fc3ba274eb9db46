#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""report.py DIR: from DIR/results.csv makes DIR/results.md, and plots beside it where there is gnuplot."""
import csv
import math
import sys

import plots

TETCAST, VTK = 'tetcast exact', 'VTK linear'


class Results:
    """The lines of results.csv, to be asked for by what they are about."""

    def __init__(self, path):
        with open(path, encoding='utf-8') as file:
            lines = [line.rstrip('\n') for line in file]
        self.machine = [line[2:] for line in lines if line.startswith('#')]
        self.rows = list(csv.DictReader(line for line in lines if not line.startswith('#')))
        for row in self.rows:
            for name, value in row.items():
                if name not in ('scene', 'task', 'case', 'renderer', 'isa', 'precision'):
                    row[name] = float(value) if value else math.nan
        frames = [row['pixels'] for row in self.rows if row['task'] == 'frame' and row['case'] == 'sharp']
        self.pixels = frames[0] if frames else math.nan  # width of the pictures that everything is measured with

    def all(self, **wanted):
        return [row for row in self.rows if all(row[name] == value for name, value in wanted.items())]

    def one(self, **wanted):
        rows = self.all(**wanted)
        return rows[0] if rows else None

    def frame(self, scene, case, renderer, threads=1, pixels=None):
        return self.one(task='frame', scene=scene, case=case, renderer=renderer, threads=threads, pixels=pixels or self.pixels)

    def scenes(self):
        return list(dict.fromkeys(row['scene'] for row in self.rows))

    def cubes(self):
        """Cubes of single precision, small to large."""
        names = [name for name in self.scenes() if name.startswith('cube') and not name.endswith('double')]
        return sorted(names, key=lambda name: self.one(scene=name)['tetrahedra'])


def number(value):
    """Three digits."""
    if value is None or math.isnan(value):
        return '–'
    if value == 0:
        return '0'
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f'{value:.{digits}f}' if 1e-3 <= abs(value) < 1e6 else f'{value:.2g}'


def count(value):
    return f'{value:,.0f}'.replace(',', ' ')


def error(row):
    return '–' if row is None else '0' if row['largest_error'] == 0 else f"{row['largest_error']:.0e}"


def ratio(slow, fast, column='cpu_s'):
    return slow[column] / fast[column] if slow and fast else math.nan


def per_cell(row):
    return 1e9 * row['cpu_s'] / row['cells_crossed'] if row else math.nan


def rays_alone(results, row):
    """Seconds of a frame of VTK without what it does before it casts rays."""
    view = results.one(task='view', **{name: row[name] for name in ('scene', 'case', 'pixels', 'renderer')})
    return row['cpu_s'] - view['cpu_s'] if view else math.nan


def table(file, head, rows):
    file.write('| ' + ' | '.join(head) + ' |\n|' + ' --- |' * len(head) + '\n')
    for row in rows:
        file.write('| ' + ' | '.join(row) + ' |\n')
    file.write('\n')


class Goals:
    """The table of what is to be reached: a line for each goal, with the scenes it was measured on."""

    def __init__(self):
        self.lines = {}

    def add(self, what, scene, value, comparison, goal, unit):
        if value is None or math.isnan(value):
            return
        reached = value >= goal if comparison == '≥' else value <= goal
        line = self.lines.setdefault((what, f'{comparison} {goal:g} {unit}'), [])
        line.append((f'{scene} {number(value)}' if reached else f'{scene} **{number(value)}**', reached))

    def rows(self):
        for (what, goal), scenes in self.lines.items():
            reached = sum(is_reached for _, is_reached in scenes)
            yield (what, goal, ', '.join(words for words, _ in scenes),
                   'yes' if reached == len(scenes) else f'{reached} of {len(scenes)}' if reached else 'no')


ISA = {'avx512': 30, 'avx2': 18}  # times faster than VTK through the soft transfer function
# Scenes with a goal of their own: times faster than VTK with tolerance 1e-3, and through the sharp transfer function, ns per cell.
SPEED = {'cube-200k': (50, 25, 8), 'cube-1.6m': (50, 50, 10), 'cube-12m': (math.nan, math.nan, 15)}


def goals(results):
    out = Goals()
    for scene in results.cubes():
        soft = results.frame(scene, 'soft', TETCAST)
        vtk = results.frame(scene, 'soft', VTK)
        tolerant, sharp, cell = SPEED.get(scene, (math.nan,) * 3)
        if not math.isnan(tolerant):
            for row in results.all(task='frame', scene=scene, case='soft', renderer=TETCAST, threads=1, pixels=results.pixels):
                if row['isa'] in ISA:
                    out.add(f"frame, exact, {row['isa']}, vs VTK linear", scene, ratio(vtk, row), '≥', ISA[row['isa']], '×')
            out.add('frame, tolerance 1e-3, vs VTK linear', scene, ratio(vtk, results.frame(scene, 'soft', 'tetcast 1e-3')),
                    '≥', tolerant, '×')
            out.add('frame, sharp, exact, vs VTK linear', scene,
                    ratio(results.frame(scene, 'sharp', VTK), results.frame(scene, 'sharp', TETCAST)), '≥', sharp, '×')
            out.add('2 threads over 1', scene, ratio(soft, results.frame(scene, 'soft', TETCAST, 2), 'wall_s'), '≥', 1.9, '×')
        if not math.isnan(cell):
            out.add(f"cell crossed, exact, {soft['isa']}", scene, per_cell(soft), '≤', cell, 'ns')
    cubes = results.cubes()
    for small in cubes:
        for large in cubes:
            a, b = results.frame(small, 'soft', TETCAST), results.frame(large, 'soft', TETCAST)
            if b['tetrahedra'] == 8 * a['tetrahedra']:
                out.add('frame when the mesh grows 8 ×', f'{small} → {large}', ratio(b, a), '≤', 2.6, '×')
    for scene in results.scenes():
        for row in results.all(task='cut', scene=scene, renderer='tetcast'):
            if row['tetrahedra'] > 100000:
                vtk = results.one(task='cut', scene=scene, renderer='VTK', case=row['case'])
                out.add(f"hexahedra cut, {row['case']}, vs vtkDataSetTriangleFilter", scene, ratio(vtk, row), '≥', 50, '×')
        preparation(results, scene, out)
        changes(results, scene, out)
    return out.rows()


def preparation(results, scene, out):
    memory = results.one(task='memory', scene=scene, renderer='tetcast')
    prepare = results.one(task='prepare', scene=scene, renderer='tetcast', threads=2)
    if not memory or memory['tetrahedra'] < 100000:
        return  # of small meshes one measures what is constant
    cells = memory['tetrahedra']
    beyond = memory['resident_bytes'] - 40 * memory['vertices']
    # A face of the shell: its own data, and its share of Embree's tree.
    out.add('resident memory per tetrahedron, beyond 40 bytes a vertex and 100 a face of the shell', scene,
            (beyond - 100 * memory['shell_faces']) / cells, '≤', 24, 'bytes')
    out.add('peak memory of preparation per tetrahedron', scene, memory['peak_bytes'] / cells, '≤', 80, 'bytes')
    if prepare:
        out.add('preparation per tetrahedron, 2 threads', scene, 1e9 * prepare['wall_s'] / cells, '≤', 150, 'ns')


def changes(results, scene, out):
    for row in results.all(task='transfer function', scene=scene, renderer=TETCAST, threads=1):
        out.add(f"new transfer function per tetrahedron, {row['case']}", scene, 1e9 * row['cpu_s'] / row['tetrahedra'],
                '≤', 5, 'ns')
    for row in results.all(task='statistics', scene=scene, case='256 bins'):
        if row['tetrahedra'] > 1000000:  # of coarser meshes a cell has values in many more bins
            out.add('statistics per tetrahedron, 256 bins', scene, 1e9 * row['cpu_s'] / row['tetrahedra'], '≤', 25, 'ns')
    out.add('1 % of the cells visible, against all', scene,
            ratio(results.frame(scene, '100 % visible', TETCAST), results.frame(scene, '1 % visible', TETCAST)), '≥', 8, '×')
    out.add('`tetcast render` of a file to PNG, over only reading and writing', scene,
            ratio(results.one(task='file to picture', scene=scene, renderer='tetcast'),
                  results.one(task='file to picture', scene=scene, renderer='reading and writing'), 'wall_s'), '≤', 1.5, '×')


def frames(results, case):
    for scene in results.scenes():
        exact, vtk = results.frame(scene, case, TETCAST), results.frame(scene, case, VTK)
        if not exact or not vtk:
            continue
        rows = {name: results.frame(scene, case, name)
                for name in ('tetcast 1e-6', 'tetcast 1e-3', 'VTK partial', 'VTK table')}
        yield (scene, count(exact['tetrahedra']), number(exact['cells_crossed'] / 1e6), number(exact['cpu_s']),
               number(per_cell(exact)), number(rows['tetcast 1e-3']['cpu_s']), number(vtk['cpu_s']), number(per_cell(vtk)),
               *(number(ratio(row, exact)) for row in (vtk, rows['VTK partial'], rows['VTK table'])),
               number(ratio(vtk, rows['tetcast 1e-3'])), number(rays_alone(results, vtk) / exact['cpu_s']),
               f"{exact['error_bound']:.0e}", *(error(row) for row in (rows['tetcast 1e-3'], vtk, rows['VTK partial'],
                                                                       rows['VTK table'])), count(vtk['pixels_off']))


FRAMES = ('scene', 'tetrahedra', 'million crossed', 'exact, s', 'ns a cell', '1e-3, s', 'VTK linear, s', 'ns a cell',
          'VTK linear / exact', 'partial / exact', 'table / exact', 'linear / 1e-3', 'linear, rays alone / exact', 'bound of exact', 'error of 1e-3',
          'of linear', 'of partial', 'of table', 'linear: pixels off by > 1e-4')


def preparations(results):
    for scene in results.scenes():
        memory = results.one(task='memory', scene=scene, renderer='tetcast')
        vtk_memory = results.one(task='memory', scene=scene, renderer='VTK')
        times = [results.one(task='prepare', scene=scene, renderer='tetcast', threads=threads) for threads in (1, 2)]
        vtk = results.one(task='prepare', scene=scene, renderer='VTK')
        view = results.one(task='view', scene=scene, renderer=VTK, case='soft')
        if not all((memory, vtk_memory, *times, vtk, view)):
            continue
        cells = memory['tetrahedra']
        yield (scene, count(cells), count(memory['vertices']), count(memory['shell_faces']),
               *(number(1e9 * row['wall_s'] / cells) for row in (*times, vtk)), number(1e9 * view['cpu_s'] / cells),
               number(memory['resident_bytes'] / cells), number(memory['peak_bytes'] / cells),
               number(vtk_memory['peak_bytes'] / cells))


PREPARATIONS = ('scene', 'tetrahedra', 'vertices', 'faces of the shell', 'ns a tet, 1 thread', '2 threads', 'VTK',
                'VTK, each view', 'resident, bytes a tet', 'peak', 'VTK, peak')


def kernels(results):
    for scene in results.scenes():
        for case in ('soft', 'sharp'):
            rows = results.all(task='frame', scene=scene, case=case, renderer=TETCAST, threads=1, pixels=results.pixels)
            yield (scene, case, *(f"{row['isa']} {number(per_cell(row))}" for row in rows))


def features(results, task='feature'):
    rows = results.all(task=task)
    base = next(iter(rows), None)
    for row in rows:
        yield (row['scene'], row['case'], number(row['cpu_s']), number(per_cell(row)),
               f'{100 * (per_cell(row) / per_cell(base) - 1):+.0f} %')


def numbers(results):
    for row in results.all(task='statistics'):
        yield (row['scene'], count(row['tetrahedra']), row['case'], number(row['cpu_s']), number(1e9 * row['cpu_s'] / row['tetrahedra']))


def parts(results):
    for frame in results.all(task='parts', renderer='frame'):
        fragments = results.one(task='parts', scene=frame['scene'], case=frame['case'], renderer='fragments')
        yield (frame['scene'], frame['case'], number(frame['cpu_s']), number(fragments['cpu_s']), number(ratio(fragments, frame)))


def isosurfaces(results):
    """Sentences about VTK's way to isosurfaces, beside a picture of tetcast's with three opaque ones."""
    for vtk in results.all(task='isosurfaces'):
        picture = results.one(task='feature', scene=vtk['scene'], case='3 opaque lit isosurfaces alone')
        if picture:
            yield (f"Three isosurfaces of {vtk['scene']}: `vtkContourFilter` takes {number(vtk['cpu_s'])} s to find their triangles, which "
                   f"are then still to be drawn. tetcast needs no triangles: its picture of {picture['pixels']:.0f}² pixels "
                   f"takes {number(picture['cpu_s'])} s. VTK takes {number(ratio(vtk, picture))} times as long.\n\n")


def others(results):
    for row in results.rows:
        if row['task'] in ('cut', 'read', 'file to picture') or \
           row['task'] == 'transfer function' and row['renderer'] == TETCAST or \
           row['task'] == 'frame' and (row['pixels'] != results.pixels or row['case'] not in ('soft', 'sharp')):
            yield (row['scene'], row['task'], row['case'], '' if math.isnan(row['pixels']) else count(row['pixels']) + '²',
                   row['renderer'], '' if math.isnan(row['threads']) else count(row['threads']), number(row['wall_s']),
                   number(row['cpu_s']), error(row) if row['renderer'] == VTK and row['task'] == 'frame' else '')


def write(results, path, figures):
    with open(path, 'w', encoding='utf-8') as file:
        file.write('# Results\n\n' + ''.join(f'* {line}\n' for line in results.machine) + '\n')
        file.write('Medians. Seconds are of CPU time and one thread, with two threads of wall time; VTK\'s contain what it does for '
                   'each view before it casts rays. Errors are the largest of any channel of any pixel against tetcast\'s exact '
                   'picture, whose own is bounded.\n\n## Goals\n\n')
        table(file, ('what', 'to reach', 'is (bold: not reached)', 'reached'), goals(results))
        for name in figures:
            file.write(f'![{name}]({name}.svg)\n\n')
        for case, words in (('soft', 'soft'), ('sharp', 'sharp (VTK ends a ray at 99 % opacity)')):
            file.write(f'## Frames, {results.pixels:.0f}² pixels, transfer function {words}\n\n')
            table(file, FRAMES, frames(results, case))
        file.write('## Preparation\n\n')
        table(file, PREPARATIONS, preparations(results))
        file.write('## Instruction sets, ns per cell crossed, exact\n\n')
        rows = list(kernels(results))
        table(file, ('scene', 'transfer function') + ('',) * (max(map(len, rows)) - 2), rows)
        file.write('## What a feature costs\n\n')
        table(file, ('scene', 'feature', 's', 'ns a cell', 'against the first'), features(results))
        file.writelines(isosurfaces(results))
        file.write('## Statistics\n\n')
        table(file, ('scene', 'tetrahedra', 'what', 's', 'ns a tet'), numbers(results))
        file.write('## Any rays\n\n')
        table(file, ('scene', 'rays', 's', 'ns a cell', 'against the first'), features(results, 'rays'))
        file.write('## Parts of a mesh\n\n')
        table(file, ('scene', 'part', 'frame, s', 'fragments, s', 'fragments / frame'), parts(results))
        file.write('## Other measurements\n\n')
        table(file, ('scene', 'what', 'case', 'pixels', 'of', 'threads', 'wall, s', 'CPU, s', 'error'), others(results))


def main():
    if len(sys.argv) != 2:
        sys.exit('usage: report.py DIR')
    results = Results(f'{sys.argv[1]}/results.csv')
    write(results, f'{sys.argv[1]}/results.md', plots.draw(results, sys.argv[1]))


if __name__ == '__main__':
    main()
