"""The curve y² + h(x)y = f(x), its models at infinity and its points."""
