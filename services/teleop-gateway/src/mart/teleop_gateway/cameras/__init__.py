"""Capture real cameras beside their hardware: `mart camera`."""
