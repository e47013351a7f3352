"""The paper's tables and figures, from files alone."""
