"""The trainer service: jobs, curves, evaluations and policies, asked for over the bus."""
