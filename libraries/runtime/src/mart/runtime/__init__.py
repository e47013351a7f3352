"""What every service runs on: the bus, settings, the command line, start and stop, logs and files that stay whole."""
