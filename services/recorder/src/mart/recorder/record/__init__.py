"""Record every episode of every room into a file of its own."""
