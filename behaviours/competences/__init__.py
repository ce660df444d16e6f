"""Ways of driving the robot, thin over the cores; each forgets everything when it loses its turn."""
