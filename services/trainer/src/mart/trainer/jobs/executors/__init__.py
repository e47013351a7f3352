"""Run jobs, on this machine or on a cluster."""
