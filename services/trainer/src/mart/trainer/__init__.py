"""Fits policies to recorded episodes, judges them and seats them beside people."""
