"""A homogeneous self-dual embedding of kinematic programs, factorised on velocities alone."""
