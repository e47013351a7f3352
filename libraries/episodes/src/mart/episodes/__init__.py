"""Reading episode files and what was said about them: for the recorder that keeps them and the trainer that learns."""
