# SPDX-License-Identifier: Apache-2.0
"""The plots of report.py, drawn by gnuplot as SVG and PNG."""
import math
import shutil
import subprocess
import sys

HEAD = '''set encoding utf8
set style line 1 lc rgb '#0060ad' lw 2.5 pt 7 ps 0.9
set style line 2 lc rgb '#e08214' lw 2 pt 5 ps 0.9
set style line 3 lc rgb '#b2182b' lw 2 pt 9 ps 1.1
set style line 4 lc rgb '#762a83' lw 2 pt 13 ps 1.2
set style line 5 lc rgb '#4d9ad0' lw 2 pt 6 ps 0.9
set style line 9 lc rgb '#888888' lw 1 dt 3
set border 3 lc rgb '#404040'
set tics nomirror textcolor rgb '#404040'
set grid lc rgb '#dddddd' lw 0.7 lt 1
set logscale xy
set format x '10^{%L}'
set key below horizontal Left reverse
'''
VTK = (('VTK linear', 2), ('VTK partial', 3), ('VTK table', 4))


def block(name, points):
    """A named block of data; points are tuples of numbers and texts."""
    lines = (' '.join(f'"{value}"' if isinstance(value, str) else f'{value:.6g}' for value in point) for point in points)
    return f'${name} << E\n' + '\n'.join(lines) + '\nE\n'


def room(values, factor=2.0):
    """A range for a logarithmic axis with some room on both sides."""
    values = [value for value in values if value > 0]
    return f'[{min(values) / factor:.3g}:{max(values) * factor:.3g}]'


def merge(points):
    """Points (x, y, label) that would lie on each other share a label: the later ones' go into the first's."""
    merged = []
    for x, y, label in points:
        near = next((other for other in merged if other[2] and abs(math.log10(x / other[0])) < 0.1
                     and abs(math.log10(y / other[1])) < 0.4), None)
        merged.append([x, y, '' if near else label])
        if near:
            near[2] = near[2].split(' … ')[0] + ' … ' + label if label[0].isdigit() else near[2] + ', ' + label.split()[-1]
    return merged


def error_over_time(results):
    """tetcast's tolerances as a curve, VTK's integrators as points; a panel for each transfer function."""
    scene = next((name for name in ('cube-1.6m', 'cube-200k') if name in results.scenes()), results.scenes()[0])
    script, times = '', []
    for case in ('soft', 'sharp'):
        curve, others, fastest = [], [], None # the fastest instruction set comes first
        for row in results.all(task='frame', scene=scene, case=case, threads=1, pixels=results.pixels):
            if row['renderer'].startswith('tetcast'):
                exact = row['renderer'] == 'tetcast exact'
                fastest = fastest or row['isa']
                point = row['cpu_s'], row['error_bound'] if exact else max(row['largest_error'], 1e-15)
                if row['isa'] == fastest:
                    curve.append((*point, row['renderer'].removeprefix('' if exact else 'tetcast ')))
                else:
                    others.append((*point, row['isa']))
            times.append(row['cpu_s'])
        script += block(f'tetcast_{case}', merge(curve)) + block(f'others_{case}', others)
        rows = sorted(((results.frame(scene, case, name), name, style) for name, style in VTK), key=lambda row: -row[0]['cpu_s'])
        points = merge([(row['cpu_s'], max(row['largest_error'], 1e-15), name) for row, name, _ in rows])
        for (_, _, style), point in zip(rows, points):
            script += block(f'vtk{style}_{case}', [point])
    cells = results.one(scene=scene)['tetrahedra']
    script += (f"set multiplot layout 1,2 title '{scene}, {cells:,.0f} tetrahedra, {results.pixels:.0f}² pixels, one thread'\n"
               f"set xrange {room(times, 4)}\nset yrange [1e-15:10]\nset ytics 1e-15, 1e3\nset format '10^{{%L}}'\nunset key\n"
               "set xlabel 'CPU seconds a frame'\nset ylabel 'largest error of a channel'\n")
    for case in ('soft', 'sharp'):
        script += (f"set title 'transfer function {case}' offset 0,-0.5\n"
                   f'plot $tetcast_{case} using 1:2 with linespoints ls 1, '
                   f"$tetcast_{case} using 1:2:3 with labels right offset -0.9,0 font ',10' textcolor rgb '#0060ad'")
        if f'$others_{case} << E\n\nE' not in script:
            script += (f', $others_{case} using 1:2 with points ls 5, '
                       f"$others_{case} using 1:2:3 with labels left rotate by -40 offset 0,-0.7 font ',9' textcolor ls 5")
        for name, style in VTK:
            script += (f', $vtk{style}_{case} using 1:2 with points ls {style} ps 1.5, $vtk{style}_{case} '
                       f"using 1:2:3 with labels left offset 0.9,0 font ',10' textcolor ls {style}")
        script += '\n'
    return script + 'unset multiplot\n'


def time_over_mesh(results):
    """How a frame takes longer as the cube's mesh gets finer."""
    cubes, script, plots, values = results.cubes(), '', [], []
    lines = (('tetcast exact', 1, 'tetcast exact'), ('tetcast 1e-3', 5, 'tetcast, tolerance 1e-3'), ('VTK linear', 2, 'VTK linear'),
             ('VTK table', 4, 'VTK table'))
    for name, style, title in lines:
        points = [(row['tetrahedra'], row['cpu_s']) for row in (results.frame(scene, 'soft', name) for scene in cubes) if row]
        script += block(f'line{style}', points)
        plots.append(f"$line{style} using 1:2 with linespoints ls {style} title '{title}'")
        values += [seconds for _, seconds in points]
    bodies = [(row['tetrahedra'], row['cpu_s'], style) for name, style, _ in lines for scene in results.scenes()
              if not scene.startswith('cube') for row in [results.frame(scene, 'soft', name)] if row]
    for style in (1, 2):
        points = [(cells, seconds) for cells, seconds, which in bodies if which == style]
        if points:
            title = ('tetcast exact', 'VTK linear')[style - 1] + ', shells and torus by TetGen'
            script += block(f'body{style}', points)
            plots.append(f"$body{style} using 1:2 with points ls {style} pt 4 ps 1.3 title '{title}'")
            values += [seconds for _, seconds in points]
    first = results.frame(cubes[0], 'soft', 'tetcast exact')
    plots.append(f"{first['cpu_s']:.6g} * (x / {first['tetrahedra']:.0f}) ** (1. / 3) with lines ls 9 title 'cells a ray: N^{{1/3}}'")
    return script + (f"set title 'soft transfer function, {results.pixels:.0f}² pixels, one thread'\n"
                     f"set yrange {room(values)}\nset xlabel 'tetrahedra'\nset ylabel 'CPU seconds a frame'\n"
                     'plot ' + ', '.join(plots) + '\n')


def time_over_size(results):
    """How a frame takes longer as the picture gets larger."""
    script, plots, values = '', [], []
    scenes = [scene for scene in results.cubes() if len(results.all(task='frame', scene=scene, case='soft', renderer='VTK linear')) > 2]
    for i, scene in enumerate(scenes):
        for name, threads, style, column in (('tetcast exact', 1, 1, 'cpu_s'), ('tetcast exact', 2, 5, 'wall_s'),
                                             ('VTK linear', 1, 2, 'cpu_s')):
            rows = results.all(task='frame', scene=scene, case='soft', renderer=name, threads=threads)
            points = sorted((row['pixels'] ** 2, row[column]) for row in rows)
            script += block(f'line{i}_{style}', points)
            words = ', 2 threads' if threads == 2 else ''
            plots.append(f"$line{i}_{style} using 1:2 with linespoints ls {style} dt {i + 1} title '{name}{words}, {scene}'")
            values += [seconds for _, seconds in points]
    if not plots:
        return ''
    sizes = sorted({row['pixels'] for row in results.all(task='frame', scene=scenes[0], case='soft', renderer='VTK linear')})
    tics = ', '.join(f"'{size:.0f}²' {size * size:.0f}" for size in sizes)
    return script + (f"set title 'soft transfer function'\nset xtics ({tics})\n"
                     f"set xrange {room([size * size for size in sizes], 1.5)}\nset yrange {room(values)}\nset xlabel 'pixels'\n"
                     "set ylabel 'seconds a frame'\nplot " + ', '.join(plots) + '\n')


def draw(results, folder):
    """Returns the names of the plots that were drawn."""
    if not shutil.which('gnuplot'):
        print('report.py: no gnuplot, no plots', file=sys.stderr)
        return []
    drawn = []
    for name, make in (('error-over-time', error_over_time), ('time-over-mesh', time_over_mesh), ('time-over-size', time_over_size)):
        script = make(results)
        if not script or not math.isfinite(results.pixels):
            continue
        for extension, terminal in (('svg', "svg size 900,520 dynamic background rgb 'white' font 'sans,12'"),
                                    ('png', "pngcairo size 1350,780 font 'sans,12' fontscale 1.2")):
            subprocess.run(['gnuplot'], check=True, encoding='utf-8', input=f"set terminal {terminal}\n"
                           f"set output '{folder}/{name}.{extension}'\n{HEAD}{script}")
        drawn.append(name)
    return drawn
