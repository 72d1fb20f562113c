"""Motions on y² = f(x) of any genus: commuting fields, maps, any time by additions. ``classical`` holds the systems."""
