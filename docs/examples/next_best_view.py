"""Six lidar scans of WORLD, each from the best of 1,000 viewpoints in the map so far: next_best_view.py WORLD.bt"""
import sys

import numpy as np

import frontlux

world = frontlux.RayCaster(frontlux.VoxelGrid.read(sys.argv[1]))  # what the lidar sees
lidar = frontlux.FieldOfView.spinning(vertical=0.6, max_range=12.0)
directions = lidar.directions(columns=720, rows=32)
live = frontlux.LiveMap(resolution=0.1)
frontiers = frontlux.FrontierSet(live.grid)
image = frontlux.ViewQualityImage(0.1, lidar)
sensor = np.array([2.0, 2.0, 1.0])
for scan in range(1, 7):
    hits = world.cast(sensor, directions, max_range=lidar.max_range, unknown="pass")
    change = live.insert(hits["end"][hits["stop"] == frontlux.RayStop.OCCUPIED], sensor)
    frontiers.update(change)
    free = live.grid.keys(frontlux.Occupancy.FREE)
    viewpoints = free[np.arange(1000) * len(free) // 1000]
    image.update(live.caster, viewpoints, frontiers.keys, change)
    sensor = live.grid.centers(viewpoints[image.best])
    print(f"scan {scan}: {len(free)} voxels free, {len(frontiers)} frontiers")
