"""Build what a world shows and holds: room, arms, materials, things; the base of every task's scene."""
