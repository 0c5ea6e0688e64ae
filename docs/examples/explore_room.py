"""A drone explores the room of WORLD in motion, and its map comes to MAP: explore_room.py WORLD.bt MAP.bt

What its camera measures are casts into WORLD: the driver of a real camera would take the place of `sense`."""
import sys

import numpy as np

import frontlux
from frontlux import planner

room = frontlux.VoxelGrid.read(sys.argv[1])
caster = frontlux.RayCaster(room)
drone = planner.Robot("drone", "space", box=(0.6, 0.6, 0.4), view=frontlux.FieldOfView.pyramid(1.5, 1.2, 8.0), columns=80,
                      rows=60, rate=5.0, speed=1.5)
directions = drone.view.directions(drone.columns, drone.rows)


def sense(robot, pose, time):
    """What the camera at a pose measures: a range for each of its directions."""
    c, s = np.cos(pose[3]), np.sin(pose[3])
    in_map = directions @ np.float32([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    hits = caster.cast(pose[:3], in_map, max_range=drone.view.max_range, unknown="pass")
    return directions, np.where(hits["stop"] == frontlux.RayStop.OCCUPIED, hits["distance"], np.float32(np.inf))


walls = room.keys(frontlux.Occupancy.OCCUPIED)
bounds = room.centers(np.stack([walls.min(axis=0), walls.max(axis=0)]))
exploration = planner.ContinuousExploration([drone], bounds, resolution=0.2)
exploration.begin(starts=[[8.45, 8.35, 1.65, 0.0]])
plans = []  # of each, plan.trajectory is what a real drone would be sent
time = planner.run(exploration, sense, until=600.0, planned=plans.append)
exploration.write(sys.argv[2])

print(f"{exploration.end} after {time:.1f} s and {len(plans)} plannings: {exploration.end_reason}")
free = room.centers(room.keys(frontlux.Occupancy.FREE))
known = exploration.grid.at(exploration.grid.keys_of(free)) != frontlux.Occupancy.UNKNOWN
print(f"{100 * known.mean():.1f} % of the room's free voxels are known, {exploration.known_volume:.0f} m3 in all")
