"""Periods and the Abel–Jacobi map over the complex numbers."""
