"""The numbers that the paper prints, by world."""

WORLDS = ("maze", "factory", "station")
COVERAGE = {"maze": 0.972, "factory": 0.975, "station": 0.960}
STEPS = {"maze": 69, "factory": 74, "station": 137}
STEPS_SAVED = 0.30  # by the team, of the UAV's alone, at least
UAV_SHARE = {"maze": (57, 64), "factory": (72, 93), "station": (66, 81)}  # [%] before and after optimisation
UAV_GAIN = {"maze": 0.105, "factory": 0.300, "station": 0.345}  # more information by optimisation
UAV_LENGTH = {"maze": (286, 252), "factory": (777, 232), "station": (713, 316)}  # [m] likewise
UAV_ALONE_LENGTH, UAV_TEAM_LENGTH = 1147, 663  # [m], in the station
DISTRIBUTION = 1.24  # the UAV's efficiency by assigning frontiers, in the factory
UAV_PLANNING = {"maze": 2.26, "factory": 4.54, "station": 4.55}  # [s] per step
UGV_PLANNING = {"maze": 0.002, "factory": 0.054, "station": 0.136}
LONGEST_PLANNING = 5.0  # [s], on average over the steps
