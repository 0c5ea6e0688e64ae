"""What a lidar of 32 beams sees from a pose in a map: lidar_scan.py MAP.bt X Y Z YAW"""
import sys

import numpy as np

import frontlux

caster = frontlux.RayCaster(frontlux.VoxelGrid.read(sys.argv[1]))
x, y, z, yaw = map(float, sys.argv[2:])

lidar = frontlux.FieldOfView.spinning(vertical=0.7, max_range=12.0)
directions = lidar.directions(columns=720, rows=32)  # (32, 720, 3), in the sensor's frame
turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
hits = caster.cast((x, y, z), directions @ turn.T, lidar.max_range, unknown="pass")
returned = hits["stop"] == frontlux.RayStop.OCCUPIED  # where castRay returns True
depth = np.where(returned, hits["distance"], np.inf)  # (32, 720) [m], an image

voxels = np.unique(hits["key"][returned], axis=0)
print(f"{returned.sum()} of {returned.size} rays return, the nearest after {depth.min():.2f} m, from {len(voxels)} voxels")
