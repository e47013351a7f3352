"""MART on one machine: starts all services, and the sessions that emulated people hold through them."""
