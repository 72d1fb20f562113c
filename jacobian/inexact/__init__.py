"""Addition with rounding: orthogonal least squares, kernels in genus 2, and the way back onto the curve."""
