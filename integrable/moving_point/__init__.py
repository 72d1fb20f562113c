"""The divisor in motion: its curve and start, translations along the flow, and the compiled loops that add them."""
