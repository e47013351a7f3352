"""Start, assign and end the processes of seats."""
