"""Drive with a phone whose own app follows it through the room."""
