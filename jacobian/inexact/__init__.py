"""Sums with rounding: orthogonal least squares, kernels in genus 2, and projection back onto the curve."""
