# SPDX-License-Identifier: BSD-3-Clause
"""How far is the first area from each of 1,000 places around the head, mm? As thousand_poses.c."""
import sys

import numpy as np

import conus

turns = np.arange(1000) * (2 * np.pi / 1000)
places = 100 * np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
answers = conus.load(sys.argv[1]).select_many(places, -places)
print(*(f"{pose[0]['distance']:.2f}" for pose in answers), sep="\n")
