"""Plots a run of `frontlux explore`, its coverage over time and the robots' paths in the map: plot_run.py RUN PICTURE.png"""
import sys

import matplotlib
import numpy as np

import frontlux

matplotlib.use("agg")
from matplotlib import pyplot as plt

recording = frontlux.read_recording(f"{sys.argv[1]}/run.frontlux")
steps, poses, grid = recording.steps, recording.poses, recording.grid()
coverage = steps["known"].sum(axis=1) / recording.observable
low, high = recording.bounds
states = grid.states(low, high)
corner = grid.centers(low) - grid.resolution / 2
width, depth = np.array(states.shape[:2]) * grid.resolution
edges = [corner[0], corner[0] + width, corner[1], corner[1] + depth]

figure, (plan, curve) = plt.subplots(1, 2, figsize=(11, 5), constrained_layout=True)
walls = (states == frontlux.Occupancy.OCCUPIED).sum(axis=2)
plan.imshow(walls.T, origin="lower", extent=edges, cmap="Greys")
for robot, name in enumerate(recording.robots):
    x, y = poses["pose"][poses["robot"] == robot, :2].T
    plan.plot(x, y, ".-", label=f"{name}, {steps['length'][:, robot].sum():.0f} m")
plan.set(xlabel="x [m]", ylabel="y [m]", title=recording.world)
plan.legend()
curve.step(steps["time"], 100 * coverage, where="post")
curve.set(xlabel="time [s]", ylabel="observable voxels mapped [%]", ylim=(0, 100))
figure.savefig(sys.argv[2])
print(f"{len(coverage)} steps, {100 * coverage[-1]:.1f} % mapped after {steps['time'][-1]:.0f} s")
