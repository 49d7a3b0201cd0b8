pts_cm = [[-4.2, -2, 5], [3.8, 1.4, -0.4]]  # left M1, right insula
