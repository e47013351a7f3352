"""What the lobby knows of the platform: kept current from the bus, shown as JSON."""
