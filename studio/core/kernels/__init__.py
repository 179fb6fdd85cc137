"""Every compiled loop of the studio lives here and nowhere else."""
