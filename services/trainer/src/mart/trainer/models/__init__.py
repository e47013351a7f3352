"""Models: what they are made of, how they are kept, and how they act once they are trained."""
